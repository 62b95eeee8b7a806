#pragma once
// CPU version of the kernel sap/subsurface_sap_tiles.comp: lists the 8x8 tiles of each level of the
// surface-aware pyramid that can hold surface. The order of the kernel's lists varies.

#include "passes/sap/sap_tiles.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace dermis::subsurface {

struct SapTile {
  uint32_t x = 0, y = 0;
  // Bit i: tile i of the 3x3 of the finer level from (2x - 1, 2y - 1) on is listed. Along an axis
  // that the step does not halve, the first tile is x - 1 or y - 1.
  uint32_t children = 0;
  uint32_t around = 0; // bit i: tile i of the 3x3 tiles of its own level around it is listed
};

struct SapTileList {
  uint32_t across = 0, down = 0; // tiles of the level, including its border
  std::vector<SapTile> tiles;    // row by row

  uint32_t groups(size_t level) const; // groups of an indirect dispatch over the list
};

// Lists the tiles of all levels. `grid`: of the view's pixels. `classes`: classes by
// subsurface.classify, one per tile of a view of width x height pixels, row by row; 0: no
// subsurface. If no class is 1 (scatters), only the first level has tiles, which are copied.
std::array<SapTileList, sap_level_count> list_sap_tiles(uint32_t width, uint32_t height,
                                                        std::span<const uint32_t> classes,
                                                        PixelGrid grid = 0);

} // namespace dermis::subsurface
