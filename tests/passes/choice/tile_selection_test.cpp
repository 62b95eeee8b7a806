// Properties of the selection of tiles that scatter.
#include "framegraph/model/splitmix.hpp"
#include "passes/choice/tile_selection.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace dermis::choice {
namespace {

bool is_chosen(uint32_t weight) {
  return weight > 0 && weight <= full_tile_weight;
}

std::vector<TileToSelect> some_tiles(size_t count, uint64_t seed) {
  SplitMix64 random{seed};
  std::vector<TileToSelect> tiles(count);
  for (TileToSelect& tile : tiles) {
    tile.scatters = random.below(4) != 0;
    tile.change = static_cast<uint32_t>(random.below(1u << random.below(24)));
  }
  return tiles;
}

TileSelection next_frame(std::vector<TileToSelect>& tiles, uint32_t units) {
  TileSelection selected = select_tiles(tiles, units, true);
  for (size_t i = 0; i < tiles.size(); ++i)
    tiles[i].before = selected.weights[i];
  return selected;
}

TEST(TileSelection, NeverExceedsTheBudget) {
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    std::vector<TileToSelect> tiles = some_tiles(500, seed);
    SplitMix64 random{seed};
    for (int frame = 0; frame < 40; ++frame) {
      const auto units = static_cast<uint32_t>(random.below(600));
      const TileSelection selected = next_frame(tiles, units);
      EXPECT_LE(selected.units, units);
      EXPECT_EQ(selected.units,
                std::count_if(selected.weights.begin(), selected.weights.end(), is_chosen));
      for (TileToSelect& tile : tiles)
        if (random.below(8) == 0) tile.change = static_cast<uint32_t>(random.below(1u << 20));
    }
  }
}

TEST(TileSelection, AmpleBudget_EachTileScatters) {
  std::vector<TileToSelect> tiles = some_tiles(300, 3);
  const TileSelection selected = select_tiles(tiles, UINT32_MAX, false);
  for (size_t i = 0; i < tiles.size(); ++i)
    EXPECT_EQ(selected.weights[i], tiles[i].scatters ? full_tile_weight : not_scattering);
  EXPECT_EQ(selected.units, selected.demand);
}

TEST(TileSelection, FirstFrame_TakesTheLargestChanges) {
  const std::vector<TileToSelect> tiles = some_tiles(500, 4);
  const TileSelection selected = select_tiles(tiles, 100, false);
  EXPECT_GE(selected.units, 93u); // a sixteenth is kept for tiles that fade
  for (size_t i = 0; i < tiles.size(); ++i)
    for (size_t j = 0; j < tiles.size(); ++j) // a bin spans an eighth of a power of two
      if (tiles[i].scatters && tiles[i].change > 1.126 * tiles[j].change && tiles[j].change > 0 &&
          is_chosen(selected.weights[j])) {
        EXPECT_TRUE(is_chosen(selected.weights[i])) << tiles[i].change << " " << tiles[j].change;
      }
}

// A host may see a weight as the fraction of scattered light, so its steps bound visible jumps.
TEST(TileSelection, SteadyBudget_WeightsChangeByOneStep) {
  std::vector<TileToSelect> tiles = some_tiles(600, 5);
  for (int frame = 0; frame < 20; ++frame)
    next_frame(tiles, 200);
  SplitMix64 random{5};
  for (int frame = 0; frame < 60; ++frame) {
    for (TileToSelect& tile : tiles) // light moves: other tiles become important
      if (random.below(frame % 20 == 0 ? 2 : 50) == 0)
        tile.change = static_cast<uint32_t>(random.below(1u << 24));
    const std::vector<TileToSelect> before = tiles;
    next_frame(tiles, 200);
    for (size_t i = 0; i < tiles.size(); ++i) {
      if (!tiles[i].scatters) continue;
      EXPECT_LE(std::abs(int(tiles[i].before) - int(before[i].before)), 1) << frame;
    }
  }
}

TEST(TileSelection, SmallDropOfTheBudget_TilesFade) {
  std::vector<TileToSelect> tiles = some_tiles(600, 6);
  for (int frame = 0; frame < 20; ++frame)
    next_frame(tiles, 320);
  const std::vector<TileToSelect> before = tiles;
  for (int frame = 0; frame < 3; ++frame)
    next_frame(tiles, 305);
  for (size_t i = 0; i < tiles.size(); ++i)
    if (is_chosen(before[i].before)) {
      EXPECT_TRUE(is_chosen(tiles[i].before));
    }
}

TEST(TileSelection, NearlyEqualChanges_TilesStay) {
  std::vector<TileToSelect> tiles(400);
  for (TileToSelect& tile : tiles)
    tile = {true, 100000, 0};
  SplitMix64 random{7};
  for (int frame = 0; frame < 20; ++frame)
    next_frame(tiles, 100);
  const std::vector<TileToSelect> steady = tiles;
  for (int frame = 0; frame < 50; ++frame) {
    for (TileToSelect& tile : tiles) // noise of 5 %
      tile.change = 100000 + static_cast<uint32_t>(random.below(5000));
    next_frame(tiles, 100);
    for (size_t i = 0; i < tiles.size(); ++i)
      EXPECT_EQ(is_chosen(tiles[i].before), is_chosen(steady[i].before)) << frame;
  }
}

TEST(TileSelection, MoreUnits_NeverFewerTilesWhenSteady) {
  const std::vector<TileToSelect> tiles = some_tiles(500, 8);
  uint32_t least = 0;
  for (uint32_t units = 0; units < 520; ++units) {
    const uint32_t taken = select_tiles(tiles, units, false).units;
    EXPECT_GE(taken, least) << units;
    least = taken;
  }
}

} // namespace
} // namespace dermis::choice
