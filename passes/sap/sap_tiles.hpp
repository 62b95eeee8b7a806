#pragma once
// Sizes of the lists of tiles over which the kernels of the surface-aware pyramid run.

#include "passes/sap/sap_weights.hpp"

#include <cstdint>

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

} // namespace dermis::subsurface
