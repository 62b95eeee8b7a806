// Tests transmitted light: its counter, and its effect on expected errors.

#include "framegraph/text/document.hpp"
#include "passes/common/environment.hpp"
#include "passes/common/profiles/profile.hpp"
#include "tests/integration/abi/dermis_fixture.hpp"

#include <array>
#include <cmath>
#include <limits>

namespace dermis::abi_test {
namespace {

struct TransmissionStats : DermisTest {
  dermis_graph graph = nullptr;

  // Options of a host that gives no scene.
  static GraphOptions without_scene() {
    GraphOptions options = shipped_options("configs/graphs/papers/restir.json");
    options.unbound = {"albedo",   "scatter_scale", "velocity",  "normal", "scene",
                       "vertices", "indices",       "instances", "lights", "scattered_light"};
    return options;
  }
  void make() { graph = make_bound_graph(without_scene()); }
  demo::ReportedFrame run_frame() { return DermisTest::run_frame(graph); }
  // Returns the measured transmission of a slab on the left half of the picture.
  double counted(float thickness_m, float light, float exposure = 1) {
    fill("thickness", [&](uint32_t x, uint32_t) { return x < 32 ? thickness_m : 0.1f; });
    fill("back_lighting", [&](uint32_t, uint32_t) { return light; });
    dermis_frame one = bound_frame(graph);
    one.exposure = exposure;
    return double(record_and_read(graph, one).transmitted_rms);
  }
};

// The fraction of Burley's profile beyond t, by channel: 1/4 e^(-t/d) + 3/4 e^(-t/3d).
TEST_F(TransmissionStats, MatchTheTransmittedLight) {
  make();
  Diagnostics diagnostics;
  const auto document =
      parse_document("skin", read_text("configs/profiles/skin.json"), diagnostics);
  const auto skin = subsurface::read_profile(*document, diagnostics);
  constexpr std::array luminance = {0.2126, 0.7152, 0.0722}; // Rec. 709
  constexpr double thickness_mm = 0.8, light = 0.5, exposure = 1.5;
  double through = 0;
  for (size_t c = 0; c < 3; ++c) {
    const double e = std::exp(-thickness_mm / (3 * skin->d_mm[c]));
    through += luminance[c] * (0.25 * e * e * e + 0.75 * e);
  }
  const double square = 0.5 * std::pow(exposure * light * through, 2); // On half of the picture.
  const double found = counted(0.8e-3f, 0.5f, 1.5f);
  // Tolerance: a step of the counter, which is rounded per tile, and the formats of thickness and
  // light.
  EXPECT_NEAR(found * found, square, 2e-3 * square + 1.0 / subsurface::through_square_steps);
  EXPECT_EQ(counted(0.8e-3f, 0), 0) << "no light from behind";
  EXPECT_EQ(counted(0.1f, 0.5f), 0) << "a decimetre";
  EXPECT_EQ(counted(std::numeric_limits<float>::quiet_NaN(), 0.5f), 0) << "an unknown thickness";
  EXPECT_LE(counted(0, 6e4f, 1e4f), 1) << "at most the brightest light";
}

TEST_F(TransmissionStats, NoThicknessBound_AreUnknown) {
  GraphOptions options = without_scene();
  options.unbound.emplace_back("thickness");
  dermis_report report = nullptr;
  ASSERT_OK(create_graph(options, &graph, &report));
  graphs.push_back(graph);
  const Said said = take(report);
  EXPECT_THAT(said.all, HasAll("does not offer 'counted': 'thickness' is not bound",
                               "does not offer 'restir': "));
  make_images(graph);
  EXPECT_EQ(run_frame().transmitted_rms, 0);
}

TEST_F(TransmissionStats, AddErrorToTechniquesWithoutTransmission) {
  make();
  const std::string table = R"({ "dermis_errors": 2, "scenes": "invented",
    "unscattered": [[1, 0.001]], "unscattered_through": 2,
    "techniques": [{ "name": "smooth", "pass_types": [{ "type": "subsurface.sap_gather" }], "rmse": [[1, 0.003]], "through": 0.5 }] })";
  const dermis_source errors = source_of(table, "invented");
  dermis_budget budget = budget_of(1e3f, DERMIS_BUDGET_DETERMINISTIC);
  budget.errors = &errors;
  ASSERT_OK(dermis_graph_set_budget(graph, &budget, nullptr));
  const double through = counted(0.8e-3f, 0.5f);
  EXPECT_NEAR(double(run_frame().predicted_rmse), std::hypot(0.003, 0.5 * through), 1e-6);
  EXPECT_EQ(counted(0.8e-3f, 0), 0); // Light from behind goes off, maybe for a moment.
  EXPECT_NEAR(double(run_frame().predicted_rmse), std::hypot(0.003, 0.5 * through), 1e-6);
  for (int i = 0; i < 70; ++i)
    run_frame();
  EXPECT_NEAR(double(run_frame().predicted_rmse), 0.003, 1e-6);
}

} // namespace
} // namespace dermis::abi_test
