// The rule that selects the tiles that scatter if not all fit the budget.
// passes/choice/tile_selection.cpp mirrors it function by function. Tiles with the largest expected
// change by scattering come first. A tile's weight rises and falls by one step per frame.
#ifndef DERMIS_TILE_SELECTION_GLSL
#define DERMIS_TILE_SELECTION_GLSL

#include "constants.glsl"
#include "common/tile_packing.glsl"

const uint selection_bins = 256u;
const uint no_bin = 0xffffffffu;
// Weights of tiles: 0 to full_tile_weight, or not_scattering.
const uint not_scattering = 255u;
const float fade_px = 8.0; // across a tile next to one of less weight

bool is_chosen(uint weight) { return weight > 0u && weight <= full_tile_weight; }

// Returns the bin of a tile's priority on a logarithmic scale with eight bins per octave: exponent
// and first bits of the priority. `entry`: of `classes`. `before`: weight in the previous frame.
uint selection_bin(uint entry, uint change, uint before) {
  if (class_of_tile(entry) != class_scatter)
    return no_bin;
  float priority = float(max(change, 1u));
  if (is_chosen(before))
    priority *= selection_stay;
  return min((floatBitsToUint(priority) >> 20) - selection_first_bin, selection_bins - 1u);
}

// Returns the units that tiles above the threshold may use. The others serve tiles that fade out.
uint steady_units(uint units, uint demand) {
  return demand <= units ? units : units - (units + selection_reserve - 1u) / selection_reserve;
}

// Returns the weight of a tile. `stays`: its priority is above the threshold. `enters`: it is, and
// the tile is affordable in addition to those that have a weight. `fades`: tiles may fade out.
// `continues`: the previous frame has weights.
uint next_weight(uint before, bool stays, bool enters, bool fades, bool continues) {
  if (!is_chosen(before))
    return !enters ? 0u : continues ? 1u : full_tile_weight;
  if (stays)
    return min(before + 1u, full_tile_weight);
  return fades ? before - 1u : 0u;
}

#endif
