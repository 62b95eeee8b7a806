#pragma once
// Results of dermis bench restir and their report.

#include "integration/tools/command/bench/report/report.hpp"
#include "integration/tools/command/bench/restir/ray_reference.hpp"
#include "integration/tools/command/bench/restir/regions.hpp"
#include "integration/tools/command/bench/restir/variants.hpp"

namespace dermis::tools {

// One technique on one scene.
struct RestirRow {
  std::string technique, setting;
  RestirVariant variant = {}; // of `restir`
  uint32_t samples = 0;       // paths per pixel and frame; 0: no paths
  double device_ms = 0;       // median
  LightError error = {};      // mean of the counted frames
  std::optional<double> ratio_to_none = {};
  std::optional<double> mse_at_most = {}; // expected limit (claims.hpp)
  std::vector<float> light = {};          // of the last frame
  bool heat_map = false;
};

struct RestirScene {
  Subject subject;
  RayReference reference;
  RayRegions regions;
  double slab_rms = 0;         // as in RayFrame, exposed
  std::vector<RestirRow> rows; // row without reuse first
};

// Adds the scene's rows and images.
void add_scene(Report& report, const RestirScene& scene);
// Returns a report with columns, title and explanations.
Report start_restir_report(const RestirFile& file);
// Formats the table for a terminal.
std::string text_of_restir(const Report& report);

} // namespace dermis::tools
