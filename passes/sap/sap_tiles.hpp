#pragma once
// Lists the 8x8 tiles of each level of the surface-aware pyramid that can hold surface, as the
// kernel sap/subsurface_sap_tiles.comp does, on the CPU.

#include "passes/sap/sap_weights.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace dermis::subsurface {

// level 0: kernels with blocks of 4x2 texels
inline constexpr uint32_t sap_tiles_per_group_first = 8;
inline constexpr uint32_t sap_tiles_per_group = 4; // other levels: blocks of 2x2 texels

struct SapTile {
  uint32_t x = 0, y = 0;
  // bit i: tile i of the 3x3 of the finer level from (2x - 1, 2y - 1) on is listed
  uint32_t children = 0;
  uint32_t around = 0; // bit i: tile i of the 3x3 tiles of its own level around it is listed
};

struct SapTileList {
  uint32_t across = 0, down = 0; // tiles of the level, including its border
  std::vector<SapTile> tiles;    // row by row

  uint32_t groups(size_t level) const; // groups of an indirect dispatch over the list
};

// Lists the tiles of all levels. `classes`: classes by subsurface.classify, one per tile of a view
// of width x height pixels, row by row; 0: no subsurface. If no class is 1 (scatters), only the
// first level has tiles, which are copied.
std::array<SapTileList, sap_level_count> list_sap_tiles(uint32_t width, uint32_t height,
                                                        std::span<const uint32_t> classes);

} // namespace dermis::subsurface
