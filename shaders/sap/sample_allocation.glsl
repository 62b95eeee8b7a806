// The rule that gives tiles their samples, shared with passes/choice/sample_allocation.cpp function by function. A tile takes
// steps 0 -> 1 -> 2 -> 3; each costs units and takes off error; what takes off most for its cost comes first.
#ifndef DERMIS_ALLOTMENT_GLSL
#define DERMIS_ALLOTMENT_GLSL

#include "constants.glsl"

const int allocation_steps = 3;
const uint allocation_bins = 256u;
const uint no_bin = 0xffffffffu;

// Units that step `k` costs: 8 samples a pixel of the tile are one.
uint step_cost(int k) { return k < 2 ? 1u : 2u; }
// Samples of a pixel of a tile that took `steps`.
int samples_of(uint steps) { return steps == 0u ? 0 : 4 << steps; }

// What step `k` takes off a tile's error, for one unit.
float step_gain(int k) { return k == 0 ? allot_gain_0 : k == 1 ? allot_gain_1 : allot_gain_2; }

// Benefit over cost on a logarithmic scale, eight bins an octave: exponent and first bits of the product, which is
// rounded alike everywhere.
uint step_bin(uint tile_error, int k, uint before) {
  if (tile_error == 0u)
    return no_bin;
  float priority = float(tile_error) * step_gain(k);
  if (before > uint(k))
    priority *= allocation_stay; // what a tile had in the frame before it keeps more easily
  return uint(clamp(int(floatBitsToUint(priority) >> 20) - allocation_first_bin, 0, int(allocation_bins) - 1));
}

#endif
