// Guidance changes only the number of samples.
#include "tests/properties/noise.hpp"

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

TEST_F(Guided, WhiteLightStaysWhite) {
  Plane plane{.width = 64, .height = 64};
  for (const char* guidance : {"split_half", "ocv"})
    run_frames("afis_guided", plane, with(guidance, {}), 3, [&](const Picture& one) {
      for (const float value : one.rgb)
        ASSERT_NEAR(value, 1, 1e-3) << guidance;
    });
}

} // namespace
