#pragma once
// Which 8x8 tiles of each level of the surface-aware pyramid can hold surface: what the kernel
// sap/subsurface_sap_tiles.comp lists, on the CPU.

#include "passes/sap/sap_weights.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace dermis::subsurface {

inline constexpr uint32_t sap_tiles_per_group_first = 8; // of level 0: kernels with blocks of 4x2 texels
inline constexpr uint32_t sap_tiles_per_group = 4;       // of the others: 2x2

struct SapTile {
  uint32_t x = 0, y = 0;
  uint32_t children = 0; // bit i: tile i of the 3x3 of the finer level from (2x - 1, 2y - 1) on is listed
  uint32_t around = 0;   // the same for the 3x3 tiles of its own level around it
};

struct SapTileList {
  uint32_t across = 0, down = 0; // tiles of the level, its border included
  std::vector<SapTile> tiles;    // row by row

  uint32_t groups(size_t level) const; // of an indirect dispatch over it
};

// `classes`: of subsurface.classify, one a tile of a view of width x height pixels, row by row; 0: nothing
// there. Where no class is 1 (scatters) the first level alone has tiles: those are copied.
std::array<SapTileList, sap_level_count> list_sap_tiles(uint32_t width, uint32_t height,
                                                        std::span<const uint32_t> classes);

} // namespace dermis::subsurface
