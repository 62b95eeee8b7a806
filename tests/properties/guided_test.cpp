// Guidance changes only the number of samples.
#include "tests/properties/noise.hpp"

#include <algorithm>
#include <cmath>

namespace {

using namespace properties;

class Guided : public DeviceTest {};

Settings with(const char* guidance, Settings more) {
  more.emplace_back("guidance", std::string("\"") + guidance + "\"");
  return more;
}

Plane step() {
  Plane plane{.width = 96, .height = 96, .d_px = {3, 3, 3}};
  plane.light = [](double x, double y) {
    return (x < 48 ? 0.2f : 0.8f) + (std::hypot(x - 30, y - 50) < 18 ? 0.2f : 0.0f);
  };
  return plane;
}

TEST_F(Guided, EqualSampleCounts_GiveEqualBits) {
  const Settings forced = {{"min_samples", "16"}, {"max_samples", "16"}};
  std::vector<Picture> first;
  run_frames("afis_guided", step(), with("spvg", forced), 3,
             [&](const Picture& one) { first.push_back(one); });
  for (const char* guidance : {"ccv", "ocv", "ocv_seed"}) {
    size_t frame = 0;
    run_frames("afis_guided", step(), with(guidance, forced), 3, [&](const Picture& one) {
      ASSERT_LT(frame, first.size());
      EXPECT_EQ(one.rgb, first[frame++].rgb) << guidance;
    });
    EXPECT_EQ(frame, 3u);
  }
}

// d such that 0.1057 of the light leaves the circle about the pixel: 1 - cdf(0.7071 px).
Picture little_scattering(const char* eps_u) {
  Plane plane = step();
  plane.d_px = {0.12, 0.12, 0.12};
  Picture last;
  run_frames("afis_guided", plane, with("ccv", {{"eps_u", eps_u}}), 1,
             [&](const Picture& one) { last = one; });
  return last;
}

TEST_F(Guided, LessThanEpsU_IsCopied) {
  const Plane plane = step();
  const Picture copied = little_scattering("0.107"), sampled = little_scattering("0.104");
  ASSERT_EQ(copied.rgb.size(), sampled.rgb.size());
  constexpr float contrast = 0.8f; // of the light
  float largest = 0;
  for (size_t i = 0; i < copied.rgb.size(); ++i) {
    const auto pixel = static_cast<uint32_t>(i / 3);
    // Half floats hold the light within 2^-12.
    EXPECT_NEAR(copied.rgb[i], plane.light(pixel % plane.width, pixel / plane.width), 3e-4);
    largest = std::max(largest, std::abs(copied.rgb[i] - sampled.rgb[i]));
  }
  EXPECT_GT(largest, 0);
  EXPECT_LE(largest, 0.107f * contrast); // D5: the step where samples begin
}

TEST_F(Guided, WhiteLightStaysWhite) {
  Plane plane{.width = 64, .height = 64};
  for (const char* guidance : {"split_half", "ocv"})
    run_frames("afis_guided", plane, with(guidance, {}), 3, [&](const Picture& one) {
      for (const float value : one.rgb)
        ASSERT_NEAR(value, 1, 1e-3) << guidance;
    });
}

} // namespace
