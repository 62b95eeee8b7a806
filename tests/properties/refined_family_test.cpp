// Samples must not make the pyramid's pictures worse on scenes of the seeded family, which have
// other surfaces than the bust.
#include "integration/tools/command/bench/family/family.hpp"
#include "integration/tools/command/bench/reference.hpp"
#include "integration/tools/command/bench/still_error.hpp"
#include "integration/tools/command/bench/technique.hpp"
#include "tests/properties/plane.hpp"
#include "tests/support/shipped_graphs.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace {

using namespace dermis::tools;

// A graph, its frames at rest, and the largest geometric mean of RMSE relative to `sap`.
struct RefinedGraph {
  const char* name;
  uint32_t frames;
  double max_mean;
};
void PrintTo(const RefinedGraph& graph, std::ostream* out) {
  *out << graph.name;
}

struct RefinedFamily : properties::DeviceTest, ::testing::WithParamInterface<RefinedGraph> {
  static constexpr uint32_t width = 144, height = 81, compared = 768; // Pixels.

  // Returns the RMSE against the reference on each scene, after `frames` frames at rest.
  static std::map<std::string, double> errors_of(demo::VulkanHost& host, const std::string& graph,
                                                 uint32_t frames) {
    Session quiet;
    quiet.quiet = true;
    std::map<std::string, double> errors;
    for (const FamilyScene& scene : family_scenes()) {
      constexpr std::array names = {"zigzag_45_d6", "grooves_d4", "step_d6",  "strips_d4",
                                    "hair_d4",      "plane_d40",  "bumps_d4", "noise_0.3_d4"};
      if (std::find(names.begin(), names.end(), scene.name) == names.end()) continue;
      const CapturedFrame frame = generate_family_scene(scene, width, height, grey_profile());
      const TechniqueRequest request{
          graph, "", DERMIS_SOURCE_DIR "/" + dermis::shipped::graph_file(graph), {}};
      auto run = TechniqueRun::create(host, request, frame.description.profiles, {});
      EXPECT_TRUE(run) << run.error().text;
      if (!run) return {};
      auto light = (*run)->scatter(frame);
      for (uint32_t i = 1; light && i < frames; ++i)
        light = (*run)->scatter(frame, true);
      EXPECT_TRUE(light) << light.error().text;
      if (!light) return {};
      const auto reference = make_reference(quiet, frame, "truth", compared, "");
      errors[scene.name] = still_error(*light, *reference).figures.rmse;
    }
    return errors;
  }
};

TEST_P(RefinedFamily, NoSceneIsWorseThanThePyramid) {
  const auto sap = errors_of(properties::shared_host(), "sap", 1);
  const auto refined = errors_of(properties::shared_host(), GetParam().name, GetParam().frames);
  ASSERT_EQ(sap.size(), 8u);
  ASSERT_EQ(refined.size(), sap.size());
  double logs = 0;
  for (const auto& [scene, error] : refined) {
    const double ratio = error / sap.at(scene);
    RecordProperty(scene, std::to_string(ratio));
    EXPECT_LE(ratio, 1.02) << scene;
    logs += std::log(ratio);
  }
  EXPECT_LE(std::exp(logs / double(refined.size())), GetParam().max_mean);
}

INSTANTIATE_TEST_SUITE_P(Graphs, RefinedFamily,
                         ::testing::Values(RefinedGraph{"hybrid", 1, 0.995},
                                           RefinedGraph{"sap_blend", 1, 0.999},
                                           RefinedGraph{"sap_residual", 24, 0.92}),
                         [](const auto& one) { return std::string(one.param.name); });

} // namespace
