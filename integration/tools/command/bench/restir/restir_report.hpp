#pragma once
// What dermis bench restir measured, and the report of it.

#include "integration/tools/command/bench/report/report.hpp"
#include "integration/tools/command/bench/restir/ray_reference.hpp"
#include "integration/tools/command/bench/restir/regions.hpp"
#include "integration/tools/command/bench/restir/variants.hpp"

namespace dermis::tools {

// One technique at one scene.
struct RestirRow {
  std::string technique, setting;
  RestirVariant variant = {}; // of `restir`
  uint32_t samples = 0;       // paths a pixel and frame; 0: draws none
  double device_ms = 0;       // median
  LightError error = {};      // mean of the counted frames
  std::optional<double> ratio_to_none = {};
  std::optional<double> mse_at_most = {}; // what is expected of it (claims.hpp)
  std::vector<float> light = {};          // of the last frame
  bool heat_map = false;
};

struct RestirScene {
  Subject subject;
  RayReference reference;
  RayRegions regions;
  double slab_rms = 0;         // as RayFrame has it, exposed
  std::vector<RestirRow> rows; // without reuse first
};

// Adds the scene's rows and pictures.
void add_scene(Report& report, const RestirScene& scene);
// Columns, title and what the figures mean.
Report start_restir_report(const RestirFile& file);
// The table for a terminal.
std::string text_of_restir(const Report& report);

} // namespace dermis::tools
