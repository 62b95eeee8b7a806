// Predicts the number of tiles in frames that have not been counted yet.
#include "passes/choice/tile_growth.hpp"

#include <gtest/gtest.h>

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

TEST(TileGrowth, NoCounts_NoPrediction) {
  EXPECT_EQ(growth_until(TileGrowth{}, 7), 1);
}

} // namespace
} // namespace dermis::choice
