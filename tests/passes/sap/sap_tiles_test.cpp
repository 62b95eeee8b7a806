// Properties of the tile lists that the surface-aware pyramid runs over.
#include "passes/common/dispatch.hpp"
#include "tests/passes/sap/cpu/tile_lists.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace dermis::subsurface {
namespace {

uint32_t along(uint32_t pixels) {
  return (pixels + 7) / 8;
}

uint32_t all_groups(uint32_t width, uint32_t height, const std::vector<uint32_t>& classes) {
  uint32_t sum = 0;
  const auto lists = list_sap_tiles(width, height, classes);
  for (size_t level = 0; level < lists.size(); ++level)
    sum += lists[level].groups(level);
  return sum;
}

std::vector<uint32_t> disc(uint32_t width, uint32_t height, double fraction) {
  std::vector<uint32_t> classes(size_t{along(width)} * along(height), 0);
  const double radius = std::sqrt(fraction * width * height / 3.14159265) / 8; // Tiles.
  for (uint32_t y = 0; y < along(height); ++y)
    for (uint32_t x = 0; x < along(width); ++x)
      if (std::hypot(double(x) + 0.5 - width / 16.0, double(y) + 0.5 - height / 16.0) < radius)
        classes[size_t{y} * along(width) + x] = 1;
  return classes;
}

TEST(SapTiles, FivePercentCoverage_LaunchesAFifthOfTheGroups) {
  for (const auto& [width, height] : {std::pair{640u, 360u}, {1280u, 720u}, {3840u, 2160u}}) {
    const double full = all_groups(width, height, disc(width, height, 10));
    // Regression bound of the present implementation.
    EXPECT_LE(all_groups(width, height, disc(width, height, 0.05)), 0.2 * full) << width;
    EXPECT_EQ(all_groups(width, height, disc(width, height, 0)), 0u);
  }
}

TEST(SapTiles, ParentsOfListedTilesAreListed) {
  const uint32_t width = 301, height = 203;
  std::vector<uint32_t> classes(size_t{along(width)} * along(height));
  for (uint32_t i = 0; i < classes.size(); ++i)
    classes[i] = i * 2654435761u >> 28 == 0; // Every sixteenth.
  const auto lists = list_sap_tiles(width, height, classes);
  for (size_t level = 0; level + 1 < lists.size(); ++level) {
    std::vector<bool> parent(size_t{lists[level + 1].across} * lists[level + 1].down);
    for (const SapTile& tile : lists[level + 1].tiles) {
      parent[size_t{tile.y} * lists[level + 1].across + tile.x] = true;
      EXPECT_NE(tile.children, 0u);
      EXPECT_NE(tile.around & 1u << 4, 0u); // The tile itself.
    }
    // Parent texel p covers texels 2p - 1 to 2p + 2; addresses are one higher from level 1 on.
    const int border = level > 0 ? 1 : 0;
    for (const SapTile& tile : lists[level].tiles)
      for (int y = 8 * int(tile.y); y < 8 * int(tile.y) + 8; ++y)
        for (int x = 8 * int(tile.x); x < 8 * int(tile.x) + 8; ++x)
          for (int k = 0; k < 4; ++k) {
            const int at_x = x - border, at_y = y - border;
            // Addresses.
            const int px = ((at_x - 1) >> 1) + k % 2 + 1, py = ((at_y - 1) >> 1) + k / 2 + 1;
            if (px / 8 >= int(lists[level + 1].across) || py / 8 >= int(lists[level + 1].down))
              continue;
            ASSERT_TRUE(parent[size_t(py / 8) * lists[level + 1].across + size_t(px / 8)])
                << level << ": " << x << " " << y;
          }
  }
}

// Views with the tiles of each level.
struct LevelTiles {
  uint32_t width = 0, height = 0;
  std::array<SapTileList, sap_level_count> lists = {};
};
std::vector<LevelTiles> views(PixelGrid grid = 0) {
  std::vector<LevelTiles> views;
  for (const auto& [width, height] : {std::pair{1u, 1u},
                                      {1u, 7u},
                                      {16u, 16u},
                                      {17u, 9u},
                                      {96u, 97u},
                                      {128u, 128u},
                                      {1u, 16384u},
                                      {16384u, 9u},
                                      {129u, 67u},
                                      {640u, 360u},
                                      {7680u, 4320u}}) {
    const std::vector<uint32_t> classes(size_t{along(width)} * along(height), 1);
    views.push_back({width, height, list_sap_tiles(width, height, classes, grid)});
  }
  return views;
}

TEST(SapTiles, ListsFitTheDeclaredBuffer) {
  // configs/graphs/sap.json: (square_view/8 + 64) elements of two entries; the first nine are the
  // heads of the lists.
  for (const double aspect : {1.0, 2.0, 0.5, 4.0, 0.25}) {
    const PixelGrid grid = pixel_grid(aspect);
    for (const LevelTiles& view : views(grid)) {
      size_t entries = sap_level_count;
      for (const SapTileList& list : view.lists)
        entries += list.tiles.size();
      const size_t square_tiles = size_t{along(view.width << pixel_doublings(grid, 0))} *
                                  along(view.height << pixel_doublings(grid, 1));
      EXPECT_LE(entries, 2 * (square_tiles + 64)) << view.width << "x" << view.height;
    }
  }
}

TEST(SapTiles, LevelsHaveTheTilesOfThePixelGrid) {
  const std::vector<uint32_t> classes(size_t{along(640)} * along(360), 1);
  const auto size = [&](double aspect, size_t level) {
    const SapTileList list = list_sap_tiles(640, 360, classes, pixel_grid(aspect))[level];
    return std::pair{list.across, list.down};
  };
  EXPECT_EQ(size(1, 1), std::pair(41u, 23u));
  EXPECT_EQ(size(2, 1), std::pair(81u, 23u));
  EXPECT_EQ(size(2, 3), std::pair(21u, 6u));
  EXPECT_EQ(size(0.25, 2), std::pair(21u, 46u));
}

// A group of the kernel has one tile of level 4, and one word of `list_state` per group.
TEST(SapTiles, RegionsCoverEveryLevel) {
  for (const LevelTiles& view : views()) {
    const GroupCount groups = group_count(over_tile_regions, view.width, view.height);
    EXPECT_EQ(groups.x, view.lists[4].across) << view.width;
    EXPECT_EQ(groups.y, view.lists[4].down) << view.height;
    EXPECT_LE(groups.total(), ceil_div(view.width, 64) * ceil_div(view.height, 64));
    EXPECT_LE(groups.total(), 4096u) << "one group reads all words up to 7680x4320";
    for (uint32_t level = 0; level < 4; ++level) {
      EXPECT_LE(view.lists[level].across, groups.x << (4 - level)) << view.width;
      EXPECT_LE(view.lists[level].down, groups.y << (4 - level)) << view.height;
    }
  }
}

TEST(SapTiles, CoarseFlagsFitTheSharedMemory) {
  static_assert(sap_coarse_words(sap_max_view_side) * sizeof(uint32_t) < 4096);
  for (const LevelTiles& view : views()) {
    size_t words = 0;
    for (size_t level = 4; level < sap_level_count; ++level)
      words += ceil_div(view.lists[level].across + 3, 32) * (view.lists[level].down + 3);
    EXPECT_LE(words, sap_coarse_words(std::max(view.width, view.height)));
  }
}

} // namespace
} // namespace dermis::subsurface
