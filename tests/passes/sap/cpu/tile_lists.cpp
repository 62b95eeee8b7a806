#include "tests/passes/sap/cpu/tile_lists.hpp"

#include "passes/common/dispatch.hpp"

#include <algorithm>

namespace dermis::subsurface {

namespace {

struct Flags {
  uint32_t across = 0, down = 0;
  std::vector<bool> set{};

  bool at(int64_t x, int64_t y) const {
    return x >= 0 && y >= 0 && x < across && y < down && set[static_cast<size_t>(y * across + x)];
  }
  // Returns a bit for each of the 3x3 tiles from (x, y) on.
  uint32_t from(int64_t x, int64_t y) const {
    uint32_t mask = 0;
    for (uint32_t i = 0; i < 9; ++i)
      mask |= at(x + i % 3, y + i / 3) ? 1u << i : 0u;
    return mask;
  }
};

uint32_t tiles_along(uint32_t pixels, PixelGrid grid, uint32_t level, uint32_t axis) {
  const uint32_t halvings = halvings_of_level(grid, level, axis);
  const uint32_t texels = ((pixels + (1u << halvings) - 1) >> halvings) + (level > 0 ? 2 : 0);
  return static_cast<uint32_t>(ceil_div(texels, tile_side));
}

} // namespace

uint32_t SapTileList::groups(size_t level) const {
  const uint32_t each = level == 0 ? sap_tiles_per_group_first : sap_tiles_per_group;
  return (static_cast<uint32_t>(tiles.size()) + each - 1) / each;
}

std::array<SapTileList, sap_level_count>
list_sap_tiles(uint32_t width, uint32_t height, std::span<const uint32_t> classes, PixelGrid grid) {
  constexpr uint32_t scatters = 1;
  const bool any = std::find(classes.begin(), classes.end(), scatters) != classes.end();
  std::array<SapTileList, sap_level_count> lists;
  Flags finer;
  for (uint32_t level = 0; level < sap_level_count; ++level) {
    Flags own{tiles_along(width, grid, level, 0), tiles_along(height, grid, level, 1)};
    const auto children_of = [&](uint32_t x, uint32_t y) {
      const auto first = [&](uint32_t tile, uint32_t axis) {
        return (int64_t{tile} << (level > pixel_doublings(grid, axis) ? 1 : 0)) - 1;
      };
      return finer.from(first(x, 0), first(y, 1));
    };
    for (uint32_t y = 0; y < own.down; ++y)
      for (uint32_t x = 0; x < own.across; ++x)
        own.set.push_back(level == 0 ? classes[size_t{y} * own.across + x] != 0
                                     : any && children_of(x, y) != 0);
    SapTileList& list = lists[level];
    list.across = own.across;
    list.down = own.down;
    for (uint32_t y = 0; y < own.down; ++y)
      for (uint32_t x = 0; x < own.across; ++x)
        if (own.at(x, y))
          list.tiles.push_back({x, y, children_of(x, y), own.from(int64_t{x} - 1, int64_t{y} - 1)});
    finer = std::move(own);
  }
  return lists;
}

} // namespace dermis::subsurface
