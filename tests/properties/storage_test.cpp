// Tests the surface-aware pyramid with float storage between levels
// (configs/overlays/sap_full_precision.json): flat light stays flat, and kernels differ from their
// CPU implementation by little more than rounding.
#include "tests/framegraph/test_scale.hpp"
#include "tests/properties/head_frames.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

namespace {

using namespace properties;
using dermis::subsurface::SapVariant;

constexpr const char* in_floats = "sap_full_precision";
constexpr double flatness = 2e-6; // Stated bound; 17 sequential roundings to 2^-24 give 1e-6.

double furthest_from(const std::vector<float>& light, float value) {
  double maximum = 0;
  for (const float one : light)
    maximum = std::max(maximum, std::abs(double(one) / double(value) - 1));
  return maximum;
}

class FullStorage : public DeviceTest, public ::testing::WithParamInterface<const char*> {};
INSTANTIATE_TEST_SUITE_P(Variants, FullStorage, ::testing::Values("base", "smooth"));

TEST_P(FullStorage, FlatLightStaysFlatToTwoMillionths) {
  if (std::string_view(GetParam()) == "base") DERMIS_FULL_TESTS_ONLY();
  const Settings variant = {{"variant", std::string("\"") + GetParam() + "\""}};
  // Every brightness with every d; the quick run uses each value once.
  constexpr std::array<float, 3> values = {0.0123f, 0.7f, 37.3f};
  constexpr std::array<double, 3> distances = {32.0, 0.5, 4.0};
  for (size_t v = 0; v < values.size(); ++v)
    for (size_t i = 0; i < distances.size(); ++i) {
      if (i != v && dermis::testing::seeds_to_try(0, 1) == 0) continue;
      const float value = values[v];
      const double d = distances[i];
      Plane plane{.width = 131, .height = 75, .d_px = {d, 0.4 * d, 0.2 * d}}; // Deliberately odd.
      plane.light = [&](double, double) { return value; };
      plane.profile = [](int x, int y) {
        return static_cast<uint8_t>((x * 7 + y * 13) % 23 == 0 ? 0 : 1);
      };
      // Small steps, and steps that give texels of every level a second layer.
      plane.depth_m = [](int x, int y) {
        return 1.0f + 0.002f * static_cast<float>((x / 9 + y / 5) % 4) +
               ((x / 31 + y / 17) % 2 == 0 ? 0.3f : 0.0f);
      };
      plane.overlay = in_floats;
      EXPECT_LE(furthest_from(run("sap", plane, variant).rgb, value), flatness)
          << value << ", d = " << d;
      plane.overlay = "";
      // None of these values is a half float, so the test detects rounding to half floats.
      EXPECT_GT(furthest_from(run("sap", plane, variant).rgb, value), 20 * flatness);
    }
}

class FullStorageOnAHead : public HeadTest {};

TEST_F(FullStorageOnAHead, FlatLightStaysFlat_LightMatchesTheCpu) {
  DERMIS_FULL_TESTS_ONLY();
  show(head_framings()[3], 640, 360, 1); // The bust from near; the test needs no reference.
  if (IsSkipped() || HasFatalFailure()) return;
  const std::vector<float> expected = cpu_kernel(frame_, SapVariant::smooth).light;
  const auto difference = [&] {
    const std::vector<float> light = scatter("sap");
    double squares = 0, count = 0;
    for (size_t i = 0; i < frame_.profile.size(); ++i) {
      if (frame_.profile[i] == 0) continue;
      for (size_t c = 0; c < 3; ++c)
        squares += std::pow(double(light[3 * i + c]) - double(expected[3 * i + c]), 2);
      count += 3;
    }
    return std::sqrt(squares / count);
  };
  const double in_halves = difference();
  overlay_ = in_floats;
  const double in_full = difference();
  RecordProperty("in_halves", std::to_string(in_halves));
  RecordProperty("in_full", std::to_string(in_full));
  EXPECT_LE(in_full, in_halves);

  const float value = 0.7f;
  std::fill(frame_.lighting.values.begin(), frame_.lighting.values.end(), value);
  const std::vector<float> flat = scatter("sap");
  for (size_t i = 0; i < frame_.profile.size(); ++i)
    for (size_t c = 0; c < 3 && frame_.profile[i] != 0; ++c)
      ASSERT_NEAR(double(flat[3 * i + c]) / double(value), 1, flatness) << i;
}

} // namespace
