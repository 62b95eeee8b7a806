#pragma once
// Selection of the tiles that scatter if not all fit the budget: the rule of
// shaders/common/subsurface_select_tiles.comp on the CPU, bit for bit
// (shaders/common/tile_selection.glsl).

#include <cstdint>
#include <span>
#include <vector>

namespace dermis::choice {

inline constexpr uint32_t selection_bins = 256;
// Weight of a pixel that shows all of its scattered light.
inline constexpr uint32_t full_pixel_weight = 240;
// Largest change of the weight at a point of a surface per frame, so that light appears or
// disappears within ten frames. A tile that leaves the list also changes its neighbours' light,
// by up to a fortieth in a pan (tests/properties). Both are less than an eighth.
inline constexpr uint32_t pixel_weight_step = 24;
// Frames until a weight that changes by this step is final.
inline constexpr uint32_t fading_frames = full_pixel_weight / pixel_weight_step;
// Instead of the weight of a pixel without subsurface.
inline constexpr uint32_t no_pixel_weight = 255;
// factor on the priority of tiles whose surface had its full weight in the previous frame
inline constexpr float selection_stay = 2.0f;
// Fractions of the units that steady tiles may use; the others serve tiles that fade out. The
// fraction falls while more tiles are kept than there are units, as under a moving camera.
inline constexpr uint32_t all_steady = 4096, min_steady = all_steady / 8;
// Gain of the fraction per frame: tiles leave after ten frames, so that a gain of 1 would
// oscillate.
inline constexpr uint32_t steady_gain = all_steady / 8;
// Exponent and three bits of 1, the lowest priority.
inline constexpr uint32_t selection_first_bin = 127 * 8;
// Bit of a tile's priority: weights in it may not fall to 0 in this frame.
inline constexpr uint32_t selection_kept_bit = 1u << 31;
// Bits of a tile's priority above the expected change: its level, by the largest weight that moved
// into the tile. Taps of neighbours read unscattered light instead of blurred light by the missing
// fraction of the levels.
inline constexpr uint32_t selection_level_shift = 28, max_selection_level = 7;
// Least weight of the highest level. At larger weights, levels would fall together with the weights
// of the tile itself.
inline constexpr uint32_t highest_level_weight = 60;

// The mean square error left by the fraction f of the tiles is (1 - f)^tile_concentration of that
// without scattering, until probes measure another exponent (error_correction.hpp). Exponents
// of 5.9 to 11 were measured at f = 0.08 to 0.3 on bust, dolly and regular, 0.3 at f = 0.4 on a
// zigzag whose tiles all change alike.
inline constexpr double tile_concentration = 5;

// State of a tile in a frame.
enum class TileState : uint32_t {
  unscattered = 0, // not listed
  fading = 1,      // listed; weights fall to 0
  shown = 2,       // listed; weights rise to full_pixel_weight
  not_scattering = 255
};

struct TileToSelect {
  bool scatters = false;
  uint32_t priority = 0; // expected change by scattering, level, and selection_kept_bit
};

struct TileSelection {
  std::vector<TileState> states; // by tile
  uint32_t units = 0;            // listed tiles
  uint32_t demand = 0;           // tiles that scatter
  uint32_t steady = all_steady;  // for the next frame
};
// Selects tiles, row by row. Lists at most `units` tiles, or all tiles whose weights may not fall
// to 0 if these are more. `steady`: of the previous frame.
TileSelection select_tiles(std::span<const TileToSelect> tiles, uint32_t units,
                           uint32_t steady = all_steady);

} // namespace dermis::choice
