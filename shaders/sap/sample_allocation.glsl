// The rule that allocates samples to tiles. passes/choice/sample_allocation.cpp mirrors it function
// by function, except previous_tile. A tile takes steps 0 -> 1 -> 2 -> 3. Each step costs units and
// reduces the tile's error; steps with the largest reduction per cost come first.
#ifndef DERMIS_SAMPLE_ALLOCATION_GLSL
#define DERMIS_SAMPLE_ALLOCATION_GLSL

#include "common/environment.glsl"
#include "constants.glsl"

const int allocation_steps = 3;
const uint allocation_bins = 256u;
const uint no_bin = 0xffffffffu;

// Returns the cost of step `k` in units. A unit is 8 samples per pixel of the tile.
uint step_cost(int k) { return k < 2 ? 1u : 2u; }
// Returns the samples per pixel of a tile that took `steps`.
int samples_of(uint steps) { return steps == 0u ? 0 : 4 << steps; }

// Returns by how much step `k` reduces a tile's error, per unit.
float step_gain(int k) { return k == 0 ? allot_gain_0 : k == 1 ? allot_gain_1 : allot_gain_2; }

// Returns the index of a tile's place in the previous frame's rectangle; that of the tile if the
// host gave no previous camera.
uint previous_tile(uint tile) {
  uvec2 now = uvec2(frame.tiles), before = uvec2(frame.previous_rect.zw + 7) / 8u;
  if (now == before || before.x * before.y == 0u)
    return tile;
  uvec2 place = (2u * uvec2(tile % now.x, tile / now.x) + 1u) * before / (2u * now);
  return place.y * before.x + place.x;
}

// Returns the bin of benefit over cost on a logarithmic scale with eight bins per octave: exponent
// and first bits of the product, whose rounding is the same on all devices.
uint step_bin(uint tile_error, int k, uint before) {
  if (tile_error == 0u)
    return no_bin;
  float priority = float(tile_error) * step_gain(k);
  if (before > uint(k))
    // Makes a tile keep the samples that it had in the previous frame.
    priority *= allocation_stay;
  return uint(clamp(int(floatBitsToUint(priority) >> 20) - allocation_first_bin, 0,
                    int(allocation_bins) - 1));
}

#endif
