// Properties of the selection of tiles that scatter.
#include "framegraph/model/splitmix.hpp"
#include "passes/choice/tile_selection.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <span>

namespace dermis::choice {
namespace {

bool is_listed(TileState state) {
  return state == TileState::fading || state == TileState::shown;
}

// A tile of a resting view, whose pixels have one weight.
struct RestingTile {
  bool scatters = false;
  uint32_t change = 0;
  uint32_t weight = 0;
};

std::vector<RestingTile> some_tiles(size_t count, uint64_t seed) {
  SplitMix64 random{seed};
  std::vector<RestingTile> tiles(count);
  for (RestingTile& tile : tiles) {
    tile.scatters = random.below(4) != 0;
    tile.change = static_cast<uint32_t>(random.below(1u << random.below(24)));
  }
  return tiles;
}

TileSelection select(std::span<const RestingTile> tiles, uint32_t units,
                     uint32_t steady = all_steady) {
  std::vector<TileToSelect> questions;
  for (const RestingTile& tile : tiles) { // as shaders/common/subsurface_tile_change.comp
    const float stay = 1 + (selection_stay - 1) * float(tile.weight) / float(full_pixel_weight);
    const auto priority = static_cast<uint32_t>(float(tile.change) * stay);
    questions.push_back(
        {tile.scatters, priority | (tile.weight > pixel_weight_step ? selection_kept_bit : 0u)});
  }
  return select_tiles(questions, units, steady);
}

// Selects tiles and changes their weights, as subsurface.separable_selected does.
TileSelection next_frame(std::vector<RestingTile>& tiles, uint32_t units,
                         uint32_t steady = all_steady) {
  TileSelection selected = select(tiles, units, steady);
  for (size_t i = 0; i < tiles.size(); ++i) {
    uint32_t& weight = tiles[i].weight;
    if (selected.states[i] == TileState::shown)
      weight = std::min(weight + pixel_weight_step, full_pixel_weight);
    else if (selected.states[i] == TileState::fading)
      weight -= std::min(weight, pixel_weight_step);
    else
      weight = 0;
  }
  return selected;
}

TEST(TileSelection, OnlyKeptTilesExceedTheBudget) {
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    std::vector<RestingTile> tiles = some_tiles(500, seed);
    SplitMix64 random{seed};
    for (int frame = 0; frame < 40; ++frame) {
      const auto units = static_cast<uint32_t>(random.below(600));
      const auto kept =
          static_cast<uint32_t>(std::ranges::count_if(tiles, [](const RestingTile& tile) {
            return tile.scatters && tile.weight > pixel_weight_step;
          }));
      const TileSelection selected = next_frame(tiles, units);
      EXPECT_LE(selected.units, std::max(units, kept));
      EXPECT_EQ(selected.units, std::ranges::count_if(selected.states, is_listed));
      for (RestingTile& tile : tiles)
        if (random.below(8) == 0) tile.change = static_cast<uint32_t>(random.below(1u << 20));
    }
  }
}

TEST(TileSelection, AmpleBudget_EachTileScatters) {
  const std::vector<RestingTile> tiles = some_tiles(300, 3);
  const TileSelection selected = select(tiles, UINT32_MAX);
  for (size_t i = 0; i < tiles.size(); ++i)
    EXPECT_EQ(selected.states[i], tiles[i].scatters ? TileState::shown : TileState::not_scattering);
  EXPECT_EQ(selected.units, selected.demand);
}

TEST(TileSelection, FirstFrame_TakesTheLargestChanges) {
  const std::vector<RestingTile> tiles = some_tiles(500, 4);
  const TileSelection selected = select(tiles, 100);
  EXPECT_EQ(selected.units, 100u);
  for (size_t i = 0; i < tiles.size(); ++i)
    for (size_t j = 0; j < tiles.size(); ++j) // a bin spans an eighth of a power of two
      if (tiles[i].scatters && tiles[i].change > 1.126 * tiles[j].change && tiles[j].change > 0 &&
          is_listed(selected.states[j])) {
        EXPECT_TRUE(is_listed(selected.states[i])) << tiles[i].change << " " << tiles[j].change;
      }
}

// A weight is the fraction of scattered light, so its steps bound visible jumps.
TEST(TileSelection, AnyBudget_WeightsChangeByOneStep) {
  std::vector<RestingTile> tiles = some_tiles(600, 5);
  SplitMix64 random{5};
  for (int frame = 0; frame < 80; ++frame) {
    for (RestingTile& tile : tiles) // light moves: other tiles become important
      if (random.below(frame % 20 == 0 ? 2 : 50) == 0)
        tile.change = static_cast<uint32_t>(random.below(1u << 24));
    const std::vector<RestingTile> before = tiles;
    next_frame(tiles, static_cast<uint32_t>(frame % 7 == 0 ? random.below(600) : 200));
    for (size_t i = 0; i < tiles.size(); ++i)
      EXPECT_LE(std::abs(int(tiles[i].weight) - int(before[i].weight)), int(pixel_weight_step))
          << frame;
  }
}

TEST(TileSelection, DropOfTheBudget_TilesFadeInTenFrames) {
  std::vector<RestingTile> tiles = some_tiles(600, 6);
  for (int frame = 0; frame < 20; ++frame)
    next_frame(tiles, 320);
  const std::vector<RestingTile> before = tiles;
  for (int frame = 1; frame <= 9; ++frame) {
    EXPECT_EQ(next_frame(tiles, 100).units, 320u);
    for (size_t i = 0; i < tiles.size(); ++i)
      if (before[i].weight == full_pixel_weight) {
        EXPECT_GT(tiles[i].weight, 0u);
      }
  }
  EXPECT_LE(next_frame(tiles, 100).units, 100u);
}

TEST(TileSelection, NearlyEqualChanges_TilesStay) {
  std::vector<RestingTile> tiles(400, RestingTile{true, 100000, 0});
  SplitMix64 random{7};
  for (int frame = 0; frame < 20; ++frame)
    next_frame(tiles, 100);
  const std::vector<RestingTile> steady = tiles;
  for (int frame = 0; frame < 50; ++frame) {
    for (RestingTile& tile : tiles) // noise of 80 %
      tile.change = 100000 + static_cast<uint32_t>(random.below(80000));
    next_frame(tiles, 100);
    for (size_t i = 0; i < tiles.size(); ++i)
      EXPECT_EQ(tiles[i].weight, steady[i].weight) << frame;
  }
}

// A row of tiles of eight pixels, across which light moves with its weights.
struct MovingRow {
  std::vector<uint32_t> light, weights; // by pixel
  uint32_t steady = all_steady;

  explicit MovingRow(size_t tiles) : weights(8 * tiles) {
    SplitMix64 random{9};
    for (size_t i = 0; i < 8 * tiles; ++i)
      light.push_back(static_cast<uint32_t>(random.below(random.below(12) == 0 ? 1u << 20 : 64)));
  }
  // Returns the number of listed tiles.
  uint32_t next_frame(uint32_t units, uint32_t pixels) {
    for (std::vector<uint32_t>* values : {&light, &weights})
      std::rotate(values->begin(), values->begin() + pixels, values->end());
    std::vector<TileToSelect> questions;
    for (size_t i = 0; i < light.size(); i += 8) {
      const bool kept = *std::max_element(&weights[i], &weights[i] + 8) > pixel_weight_step;
      questions.push_back(
          {true, *std::max_element(&light[i], &light[i] + 8) | (kept ? selection_kept_bit : 0u)});
    }
    const TileSelection selected = select_tiles(questions, units, steady);
    for (size_t i = 0; i < light.size(); ++i)
      if (selected.states[i / 8] == TileState::shown)
        weights[i] = std::min(weights[i] + pixel_weight_step, full_pixel_weight);
      else
        weights[i] -= std::min(weights[i], pixel_weight_step);
    steady = selected.steady;
    return selected.units;
  }
};

// Weights of a tile move into two tiles, which are both kept.
TEST(TileSelection, MovingView_KeepsToTheBudget) {
  MovingRow row(2000);
  double listed = 0;
  for (int frame = 0; frame < 200; ++frame) {
    const uint32_t units = row.next_frame(400, 3);
    if (frame >= 100) listed += units;
  }
  EXPECT_LT(row.steady, all_steady);
  EXPECT_NEAR(listed / 100, 400, 8);
  for (int frame = 0; frame < 100; ++frame)
    row.next_frame(400, 0);
  EXPECT_EQ(row.steady, all_steady);
  EXPECT_EQ(row.next_frame(400, 0), 400u);
}

TEST(TileSelection, MoreUnits_NeverFewerTilesWhenSteady) {
  const std::vector<RestingTile> tiles = some_tiles(500, 8);
  uint32_t least = 0;
  for (uint32_t units = 0; units < 520; ++units) {
    const uint32_t taken = select(tiles, units).units;
    EXPECT_GE(taken, least) << units;
    least = taken;
  }
}

} // namespace
} // namespace dermis::choice
