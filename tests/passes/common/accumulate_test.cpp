// Accumulation of light over frames: the arithmetic that subsurface.accumulate shares with the
// bench.
#include "passes/common/accumulate.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

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

TEST(Accumulate, HistoryNearItsNeighboursIsUnchanged) {
  const AccumulatedLight history{{1.0, 2.0, 3.0}, 7};
  const AccumulatedLight kept = clip_to_neighbours(history, {1.1, 2.1, 2.9}, {0.1, 0.1, 0.1}, 1.5);
  EXPECT_EQ(kept.light, history.light);
  EXPECT_EQ(kept.count, 7);
}

TEST(Accumulate, HistoryFarFromNeighbours_IsClippedAndCountsLess) {
  const AccumulatedLight far{{3.0, 2.0, 1.0}, 8};
  const AccumulatedLight clipped = clip_to_neighbours(far, {1, 1, 1}, {0.25, 1, 1}, 2);
  // Red is 2 from the mean with a limit of 0.5, so all channels keep a quarter of the difference.
  EXPECT_NEAR(clipped.light[0], 1.5, 1e-15);
  EXPECT_NEAR(clipped.light[1], 1.25, 1e-15);
  EXPECT_NEAR(clipped.light[2], 1.0, 1e-15);
  EXPECT_NEAR(clipped.count, 2, 1e-15);
  // If all neighbours are equal, only their value is accepted.
  const AccumulatedLight flat = clip_to_neighbours(far, {1, 1, 1}, {0, 0, 0}, 2);
  EXPECT_EQ(flat.light, (std::array<double, 3>{1, 1, 1}));
  EXPECT_EQ(flat.count, 0);
}

constexpr std::array<double, 3> near_light = {0.2, 0.5, 0.0}, local_mean = {0.4, 0.6, 0.3};

TEST(Accumulate, RemaindersReproduceTheLight) {
  const std::array<double, 3> light = {0.25, 0.4, 0.1};
  const std::array<double, 3> remainder = remainder_of(light, near_light, local_mean);
  EXPECT_NEAR(remainder[1], (0.4 - 0.5) / 0.6, 1e-15); // Signed.
  const std::array<double, 3> found = light_of_remainder(remainder, near_light, local_mean);
  for (size_t c = 0; c < 3; ++c)
    EXPECT_NEAR(found[c], light[c], 1e-15);
}

TEST(Accumulate, RemainderIsIndependentOfTheBrightness) {
  const std::array<double, 3> light = {0.25, 0.4, 0.1};
  const std::array<double, 3> dim = remainder_of(light, near_light, local_mean);
  for (const double factor : {1e-4, 0.5, 60.0}) {
    const auto scaled = [&](std::array<double, 3> values) {
      for (double& value : values)
        value *= factor;
      return values;
    };
    const std::array<double, 3> bright =
        remainder_of(scaled(light), scaled(near_light), scaled(local_mean));
    for (size_t c = 0; c < 3; ++c)
      EXPECT_NEAR(bright[c], dim[c], 1e-12) << factor;
  }
}

TEST(Accumulate, LightOfARemainderIsNeverBelowZero) {
  EXPECT_EQ(light_of_remainder({-4, -4, -4}, near_light, local_mean),
            (std::array<double, 3>{0, 0, 0}));
}

TEST(Accumulate, ExcessiveRemaindersAreDiscarded) {
  EXPECT_TRUE(can_be_kept({0, 4.5, -4.5}));
  EXPECT_FALSE(can_be_kept({0, 0, 4.51}));
  EXPECT_FALSE(can_be_kept({-4.51, 0, 0}));
  EXPECT_FALSE(can_be_kept(remainder_of({1, 1, 1}, {0, 0, 0}, {0, 0, 0}))); // In the dark.
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
