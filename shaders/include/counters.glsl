// What a frame tells the host: FrameCounters of passes/subsurface/environment.hpp.
#ifndef DERMIS_COUNTERS_GLSL
#define DERMIS_COUNTERS_GLSL

layout(std430, set = 1, binding = 6) buffer counter_block {
  uint scattering_tiles;
  uint copied_tiles;
  uint log2_d_sum;
} counters;

void count_scattering_tile(float d_px) {
  atomicAdd(counters.scattering_tiles, 1u);
  float steps = (log2(d_px) + counter_log2_shift) * counter_log2_steps;
  atomicAdd(counters.log2_d_sum, uint(clamp(steps, 0.0, 32.0 * counter_log2_steps - 1.0)));
}

#endif
