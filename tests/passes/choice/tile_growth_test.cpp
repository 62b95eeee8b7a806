// Predicts the number of tiles in frames that have not been counted yet.
#include "passes/choice/tile_growth.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace dermis::choice {
namespace {

TEST(TileGrowth, ApproachingCamera_IsExtrapolated) {
  TileGrowth growth_estimate;
  constexpr double step = 1.1;
  for (uint64_t frame = 1; frame <= 20; ++frame)
    update_growth(growth_estimate, frame,
                  static_cast<uint64_t>(1000 * std::pow(step, double(frame))));
  EXPECT_NEAR(growth_estimate.growth, step, 1e-3); // Counts are whole tiles.
  EXPECT_NEAR(growth_until(growth_estimate, 22), step * step, 2e-3);
  EXPECT_EQ(growth_until(growth_estimate, 20), 1);
}

TEST(TileGrowth, SkippedFrames_GiveEqualGrowth) {
  TileGrowth growth_estimate;
  for (uint64_t frame = 3; frame <= 30; frame += 3)
    update_growth(growth_estimate, frame,
                  static_cast<uint64_t>(1000 * std::pow(1.1, double(frame))));
  EXPECT_NEAR(growth_estimate.growth, 1.1, 1e-3);
}

TEST(TileGrowth, Cut_IsNotExtrapolated) {
  TileGrowth growth_estimate;
  for (uint64_t frame = 1; frame <= 30; ++frame) {
    update_growth(growth_estimate, frame, frame < 10 ? 100 : 900);
    EXPECT_EQ(growth_estimate.growth, 1) << frame;
  }
}

TEST(TileGrowth, Shrinking_IsNotExtrapolated) {
  TileGrowth growth_estimate;
  for (uint64_t frame = 1; frame <= 20; ++frame)
    update_growth(growth_estimate, frame, 2000 - 90 * frame);
  EXPECT_EQ(growth_until(growth_estimate, 25), 1);
}

TEST(TileGrowth, FewTiles_AreIgnoredAndGrowthIsBounded) {
  TileGrowth growth_estimate;
  for (uint64_t frame = 1; frame <= 4; ++frame)
    update_growth(growth_estimate, frame, 2 * frame);
  EXPECT_EQ(growth_estimate.growth, 1);
  for (uint64_t frame = 5; frame <= 12; ++frame)
    update_growth(growth_estimate, frame, uint64_t{8} << (2 * (frame - 5)));
  EXPECT_EQ(growth_estimate.growth, max_growth);
  EXPECT_EQ(growth_until(growth_estimate, 1000), max_growth * max_growth);
}

// As of a character that was hidden for a while.
TEST(TileGrowth, SlowGrowth_EndsWithTheCounts) {
  TileGrowth growth_estimate;
  for (uint64_t frame = 1; frame <= 20; ++frame)
    update_growth(growth_estimate, frame,
                  static_cast<uint64_t>(1e5 * std::pow(1.01, double(frame))));
  EXPECT_NEAR(growth_until(growth_estimate, 22), std::pow(1.01, 2), 1e-3);
  EXPECT_NEAR(growth_until(growth_estimate, 1000), std::pow(1.01, 8), 1e-3);
}

TEST(TileGrowth, NoCounts_NoPrediction) {
  EXPECT_EQ(growth_until(TileGrowth{}, 7), 1);
}

// Counts the cells of a unit grid that an ellipse touches, up to the sampling.
double cells_of_ellipse(double a, double b) {
  double cells = 0;
  for (int y = -60; y < 60; ++y)
    for (int x = -60; x < 60; ++x) {
      // The nearest point of the cell to the centre, which is off the grid.
      const double u = std::clamp(0.0, x + 0.3, x + 1.3), v = std::clamp(0.0, y + 0.4, y + 1.4);
      cells += u * u / (a * a) + v * v / (b * b) <= 1 ? 1 : 0;
    }
  return cells;
}

TEST(ScaledTiles, FollowCompactShapesAtOtherResolutions) {
  for (const double aspect : {1.0, 0.7})
    for (const double from : {6.0, 12.0, 25.0})
      for (const double scale : {0.5, 0.75, 1.0, 1.5, 2.0}) {
        const double expected = cells_of_ellipse(scale * from, scale * aspect * from);
        const double found = scaled_tiles(cells_of_ellipse(from, aspect * from), scale);
        EXPECT_NEAR(found, expected, 0.05 * expected) << from << " times " << scale;
      }
  EXPECT_EQ(scaled_tiles(0, 2), 0);
  EXPECT_GE(scaled_tiles(1, 0.1), 1);
}

TEST(ScaledTiles, ResolutionIsNoGrowth) {
  TileGrowth growth;
  uint64_t tiles = 1000;
  for (uint64_t frame = 1; frame < 8; ++frame) {
    const double larger = scaled_tiles(double(tiles), 1.1);
    rescale(growth, 1.1);
    tiles = static_cast<uint64_t>(std::lround(larger));
    update_growth(growth, frame, tiles);
  }
  EXPECT_NEAR(growth_until(growth, 9), 1, 0.01);
}

} // namespace
} // namespace dermis::choice
