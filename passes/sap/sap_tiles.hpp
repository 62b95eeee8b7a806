#pragma once
// Lists the 8x8 tiles of each level of the surface-aware pyramid that can hold surface, on the CPU.
// The kernel sap/subsurface_sap_tiles.comp lists the same tiles in an order that varies.

#include "passes/sap/sap_weights.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace dermis::subsurface {

// level 0: kernels with blocks of 4x2 texels
inline constexpr uint32_t sap_tiles_per_group_first = 8;
inline constexpr uint32_t sap_tiles_per_group = 4; // other levels: blocks of 2x2 texels

inline constexpr uint32_t sap_max_view_side = 16384; // pixels
// Returns the words for the flags of the tiles of levels 4 to 8 of a square view. A level has three
// more rows and columns of flags than of tiles.
constexpr uint32_t sap_coarse_words(uint32_t view_side) {
  uint32_t words = 0;
  for (uint32_t level = 4; level < sap_level_count; ++level) {
    const uint32_t texels = ((view_side + (1u << level) - 1) >> level) + 2;
    const uint32_t flags = (texels + 7) / 8 + 3;
    words += (flags + 31) / 32 * flags;
  }
  return words;
}
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
