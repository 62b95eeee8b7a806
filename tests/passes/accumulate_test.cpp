// Light over frames: the arithmetic that subsurface.accumulate shares with the bench.
#include "passes/subsurface/temporal/accumulate.hpp"

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
      const double x = k - 1; // of the texel; the second one is 0
      sum += weight[size_t(k)];
      line += weight[size_t(k)] * x;
      parabola += weight[size_t(k)] * x * x;
    }
    EXPECT_NEAR(sum, 1, 1e-15);
    EXPECT_NEAR(line, part, 1e-15);
    EXPECT_NEAR(parabola, part * part, 1e-15);
  }
  EXPECT_EQ(catmull_rom(0), (std::array<double, 4>{0, 1, 0, 0})); // a camera that rests reads one texel
}

TEST(Accumulate, HistoryWithinReachOfItsNeighboursStaysAsItIs) {
  const AccumulatedLight history{{1.0, 2.0, 3.0}, 7};
  const AccumulatedLight kept = clip_to_neighbours(history, {1.1, 2.1, 2.9}, {0.1, 0.1, 0.1}, 1.5);
  EXPECT_EQ(kept.light, history.light);
  EXPECT_EQ(kept.count, 7);
}

TEST(Accumulate, HistoryBeyondReachIsDrawnToItsEdgeAlongTheLineAndCountsForAsMuchLess) {
  const AccumulatedLight far{{3.0, 2.0, 1.0}, 8};
  const AccumulatedLight drawn = clip_to_neighbours(far, {1, 1, 1}, {0.25, 1, 1}, 2);
  // Red lies 2 from the mean and may lie .5: a quarter of the way is kept in all channels.
  EXPECT_NEAR(drawn.light[0], 1.5, 1e-15);
  EXPECT_NEAR(drawn.light[1], 1.25, 1e-15);
  EXPECT_NEAR(drawn.light[2], 1.0, 1e-15);
  EXPECT_NEAR(drawn.count, 2, 1e-15);
  // Where all neighbours are alike nothing else is believed.
  const AccumulatedLight flat = clip_to_neighbours(far, {1, 1, 1}, {0, 0, 0}, 2);
  EXPECT_EQ(flat.light, (std::array<double, 3>{1, 1, 1}));
  EXPECT_EQ(flat.count, 0);
}

// A tile of light that has a pattern, `factor` times as bright as before, with noise on both sides.
LightPairs lit_tile(double factor, double noise, uint32_t seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  LightPairs pairs;
  for (int i = 0; i < 64; ++i) {
    const double pattern = 0.1 + i / 64.0; // much more than the noise
    std::array<double, 3> now{}, before{};
    for (size_t c = 0; c < 3; ++c) {
      before[c] = pattern;
      now[c] = factor * pattern + noise * normal(random);
    }
    add_pixel(pairs, now, before);
  }
  return pairs;
}

TEST(Accumulate, LightThatFlashesIsFollowedWhateverItsPattern) {
  for (const double factor : {0.0, 0.01, 0.9, 0.999, 1.001, 1.5, 60.0})
    for (const double change : brightness_change(lit_tile(factor, 0, 1)))
      EXPECT_NEAR(change, factor, 1e-6) << factor;
  // With noise of a twentieth the mean of 64 pixels is known within a hundredth.
  for (const double change : brightness_change(lit_tile(1.5, 0.03, 2)))
    EXPECT_NEAR(change, 1.5, 0.05);
}

TEST(Accumulate, NoiseOfSamplesIsNoChangeOfLight) {
  int changes = 0;
  double squares = 0;
  constexpr int tiles = 2000;
  for (int i = 0; i < tiles; ++i)
    for (const double change : brightness_change(lit_tile(1, 0.05, uint32_t(i)))) {
      changes += change != 1;
      squares += (change - 1) * (change - 1);
    }
  // Beyond three standard errors lie .27 % of independent values.
  EXPECT_LT(changes, 0.006 * 3 * tiles);
  EXPECT_GT(changes, 0);
  EXPECT_LT(std::sqrt(squares / (3 * tiles)), 0.1 * 0.05 / 8 / 0.6); // a tenth of the mean's own error
}

TEST(Accumulate, AShadowThatMovesAndTilesOfFewPixelsAreNoChangeOfLight) {
  LightPairs moved, few;
  for (int i = 0; i < 64; ++i) {
    const double now = i < 40 ? 1 : 0, before = i < 36 ? 1 : 0;
    add_pixel(moved, {now, now, now}, {before, before, before});
  }
  for (int i = 0; i + 1 < change_least_pixels; ++i)
    add_pixel(few, {2, 2, 2}, {1, 1, 1});
  EXPECT_EQ(brightness_change(moved), (std::array<double, 3>{1, 1, 1}));
  EXPECT_EQ(brightness_change(few), (std::array<double, 3>{1, 1, 1}));
  EXPECT_EQ(brightness_change({}), (std::array<double, 3>{1, 1, 1}));
}

TEST(Accumulate, TheFirstFramesAreMeantEvenlyAndLaterOnesMove) {
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
