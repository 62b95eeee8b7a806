#version 460
// Sums the cost of the steps of samples that tiles can take, by bin, for a run of tiles in row
// order per group.
#extension GL_GOOGLE_include_directive : require
#include "sap/subsurface_sample_demand.bindings.glsl"
#include "common/environment.glsl"
#include "constants.glsl"
#include "common/tile_packing.glsl"
#include "sap/sample_allocation.glsl"

const uint lanes = 128u;
layout(local_size_x = 128, local_size_y = 1, local_size_z = 1) in;

shared uint cost_of_bin[allocation_bins];

void main() {
  uint lane = gl_LocalInvocationIndex;
  for (uint bin = lane; bin < allocation_bins; bin += lanes)
    cost_of_bin[bin] = 0u;
  barrier();
  uint first = gl_WorkGroupID.x * tiles_per_run_group;
  uint last = min(first + tiles_per_run_group, uint(frame.tiles.x * frame.tiles.y));
  for (uint tile = first + lane; tile < last; tile += lanes) {
    if (class_of_tile(classes_data[tile]) != class_scatter)
      continue;
    uint tile_error = tile_errors_data[tile], before = has_before() ? before_data[tile] : 0u;
    for (int k = 0; k < allocation_steps; ++k) {
      uint bin = step_bin(tile_error, k, before);
      if (bin != no_bin)
        atomicAdd(cost_of_bin[bin], step_cost(k));
    }
  }
  barrier();
  for (uint bin = lane; bin < allocation_bins; bin += lanes)
    demand_data[gl_WorkGroupID.x * allocation_bins + bin] = cost_of_bin[bin];
}
