#pragma once
// Selection of the tiles that scatter if not all fit the budget: the rule of
// shaders/common/subsurface_select_tiles.comp on the CPU, bit for bit
// (shaders/common/tile_selection.glsl).

#include <cstdint>
#include <span>
#include <vector>

namespace dermis::choice {

inline constexpr uint32_t selection_bins = 256;
// Weight of a tile that shows all of its scattered light. The weight of a tile changes by at most 1
// per frame, so a tile appears or disappears within as many frames.
inline constexpr uint32_t full_tile_weight = 8;
// Weight of tiles that do not scatter.
inline constexpr uint32_t not_scattering = 255;
// factor on the priority of tiles that had a weight in the frame before
inline constexpr float selection_stay = 1.2f;
// One unit of this many is kept for tiles that fade out.
inline constexpr uint32_t selection_reserve = 16;
// Exponent and three bits of 1, the lowest priority.
inline constexpr uint32_t selection_first_bin = 127 * 8;

// The mean square error left by the fraction f of the tiles is (1 - f)^tile_concentration of that
// without scattering: an upper estimate. Exponents of 5.9 to 11 were measured at f = 0.08 to 0.3 on
// bust, dolly and regular.
inline constexpr double tile_concentration = 5;

struct TileToSelect {
  bool scatters = false;
  uint32_t change = 0; // expected, by scattering
  uint32_t before = 0; // weight in the frame before
};

struct TileSelection {
  std::vector<uint32_t> weights; // by tile
  uint32_t units = 0;            // tiles with a weight
  uint32_t demand = 0;           // tiles that scatter
};
// Selects tiles, row by row. Gives at most `units` tiles a weight. `continues`: the frame before
// has weights; otherwise tiles have their full weight at once.
TileSelection select_tiles(std::span<const TileToSelect> tiles, uint32_t units, bool continues);

} // namespace dermis::choice
