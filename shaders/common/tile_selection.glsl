// The rule that selects the tiles that scatter if not all fit the budget.
// passes/choice/tile_selection.cpp mirrors it function by function. Tiles with the largest expected
// change by scattering come first. The weight of a point of a surface, the fraction of scattered
// light that the point shows, changes by at most pixel_weight_step per frame.
#ifndef DERMIS_TILE_SELECTION_GLSL
#define DERMIS_TILE_SELECTION_GLSL

#include "constants.glsl"
#include "common/tile_packing.glsl"

const uint selection_bins = 256u;
const uint no_bin = 0xffffffffu;
// States of tiles.
const uint state_unscattered = 0u;
const uint state_fading = 1u; // listed; weights fall to 0
const uint state_shown = 2u;  // listed; weights rise to full_pixel_weight
const uint state_not_scattering = 255u;
// A tile's word: its state, and above it its level.
const uint state_bits = 8u;
const float fade_px = 8.0; // across a tile next to one that is not shown

uint state_of_word(uint word) { return word & ((1u << state_bits) - 1u); }
uint level_of_word(uint word) { return word >> state_bits; }

bool is_listed(uint state) { return state == state_fading || state == state_shown; }

bool is_kept(uint priority) { return (priority & selection_kept_bit) != 0u; }

// Returns the bin of a tile's priority on a logarithmic scale with eight bins per octave: exponent
// and first bits of the priority. `entry`: of `classes`.
uint selection_bin(uint entry, uint priority) {
  if (class_of_tile(entry) != class_scatter)
    return no_bin;
  float value = float(max(priority & ((1u << selection_level_shift) - 1u), 1u));
  return min((floatBitsToUint(value) >> 20) - selection_first_bin, selection_bins - 1u);
}

// Returns the units that tiles above the threshold may use. The others serve tiles that fade out.
uint steady_units(uint units, uint demand, uint steady) {
  if (demand <= units)
    return units;
  return units / all_steady * steady + units % all_steady * steady / all_steady;
}

// Returns the fraction of the units for steady_units(), from that of the previous frame. `kept`:
// number of kept tiles.
uint next_steady(uint steady, uint units, uint demand, uint kept) {
  if (demand <= units || units == 0u)
    return all_steady;
  int all = int(units), limit = max(all / 8, 1);
  int free = clamp(all - int(kept), -limit, limit);
  return uint(clamp(int(steady) + free * int(steady_gain) / all, int(min_steady),
                    int(all_steady)));
}

// Returns the state of a tile that scatters. `stays`: its priority is above the threshold.
// `affordable`: the tile is kept, or affordable in addition to those that are.
uint state_of(bool kept, bool stays, bool affordable) {
  if (stays && affordable)
    return state_shown;
  return kept ? state_fading : state_unscattered;
}

// Returns the index of the word that holds the weight of a pixel among those of its tile. A tile
// has 64 weights of 8 bits in 16 words, row by row.
uint weight_word(uvec2 pixel) { return (pixel.y & 7u) * 2u + (pixel.x >> 2 & 1u); }
const uint words_per_tile = 16u;

#endif
