// Counters that a frame reports to the host: FrameCounters of passes/common/environment.hpp.
#ifndef DERMIS_COUNTERS_GLSL
#define DERMIS_COUNTERS_GLSL

#include "constants.glsl"

layout(std430, set = 1, binding = 6) buffer counter_block {
  uint scattering_tiles;
  uint copied_tiles;
  uint log2_d_sum;
  uint uniform_tiles;
  uint level_groups[9];
  uint sampled_tiles[3];
  uint sample_units;
  uint sample_demand;
  uint probe_count;
  uint through_steps;
  uint relief_sum;
  uint relief_pixels;
  uvec2 probes[32];
  uint probed_unscattered[32];
  uint probed_separable[32];
} counters;

uint counter_steps(float d_px) {
  float steps = (log2(d_px) + counter_log2_shift) * counter_log2_steps;
  return uint(clamp(steps, 0.0, 32.0 * counter_log2_steps - 1.0));
}

// Adds to the tile counters. `steps` is the sum of counter_steps over the scattering tiles.
void count_tiles(uint scattering, uint copied, uint steps) {
  if (scattering != 0u) {
    atomicAdd(counters.scattering_tiles, scattering);
    atomicAdd(counters.log2_d_sum, steps);
  }
  if (copied != 0u)
    atomicAdd(counters.copied_tiles, copied);
}

// Moves tiles that were counted as scattering to the tiles with uniform light. `steps` is the sum
// of their counter_steps.
void recount_as_uniform(uint tiles, uint steps) {
  atomicAdd(counters.scattering_tiles, 0u - tiles);
  atomicAdd(counters.log2_d_sum, 0u - steps);
  atomicAdd(counters.uniform_tiles, tiles);
}

#endif
