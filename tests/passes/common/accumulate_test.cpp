// Accumulation of light over frames: the arithmetic that subsurface.accumulate shares with the
// bench.
#include "passes/common/accumulate.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace dermis::subsurface {
namespace {

TEST(Accumulate, CubicWeightsSumToOneAndFollowParabolasExactly) {
  for (int i = 0; i <= 64; ++i) {
    const double part = i / 64.0;
    const std::array<double, 4> weight = catmull_rom(part);
    double sum = 0, line = 0, parabola = 0;
    for (int k = 0; k < 4; ++k) {
      const double x = k - 1; // Position of the texel; the second texel is at 0.
      sum += weight[size_t(k)];
      line += weight[size_t(k)] * x;
      parabola += weight[size_t(k)] * x * x;
    }
    EXPECT_NEAR(sum, 1, 1e-15);
    EXPECT_NEAR(line, part, 1e-15);
    EXPECT_NEAR(parabola, part * part, 1e-15);
  }
  // A camera at rest reads one texel.
  EXPECT_EQ(catmull_rom(0), (std::array<double, 4>{0, 1, 0, 0}));
}

TEST(Accumulate, FirstFramesAverageEvenly_LaterOnesMove) {
  AccumulatedLight sum{};
  double mean = 0;
  for (int frame = 1; frame <= 10; ++frame) {
    const double light = std::sin(frame);
    mean += light / 10;
    sum = add_frame(sum, {light, light, light}, 0.1);
  }
  EXPECT_NEAR(sum.light[1], mean, 1e-15);
  EXPECT_EQ(sum.count, 10);
  const AccumulatedLight next = add_frame(sum, {2, 2, 2}, 0.1);
  EXPECT_NEAR(next.light[0], mean + 0.1 * (2 - mean), 1e-15);
  EXPECT_EQ(next.count, 10);
}

} // namespace
} // namespace dermis::subsurface
