#pragma once
// Rows of dermis bench restir and their images.

#include "integration/tools/command/bench/restir/ray_reference.hpp"
#include "integration/tools/command/bench/restir/regions.hpp"
#include "integration/tools/command/bench/restir/variants.hpp"
#include "integration/tools/command/bench/suite/suite.hpp"

namespace dermis::tools {

struct RestirScene;

// One technique on one scene.
struct RestirRow {
  std::string technique, setting;
  RestirVariant variant = {}; // of `restir`
  uint32_t samples = 0;       // paths per pixel and frame; 0: no paths
  double device_ms = 0;       // median
  LightError error = {};      // mean of the counted frames
  std::optional<double> ratio_to_none = {};
  std::optional<double> max_mse = {}; // expected limit (claims.hpp)
  std::vector<float> light = {};      // of the last frame
  bool heat_map = false;
  const RestirScene* scene = nullptr; // set when the scene is complete
};

struct RestirScene {
  Subject subject;
  RayReference reference;
  RayRegions regions;
  double slab_rms = 0;         // as in RayFrame, exposed
  std::vector<RestirRow> rows; // row without reuse first
};

demo::Result<> measure_restir(SuiteRun& run, const Emit<RestirRow>& emit);
// Adds the facts and the groups of images.
void start_restir_report(SuiteRun& run, const RestirFile& file);
void add_pictures(Report& report, const RestirScene& scene);

} // namespace dermis::tools
