#version 460
// Sums the cost of the steps of samples that tiles can take, by bin, for a run of tiles in row
// order per group.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "sap/subsurface_sample_demand.bindings.glsl"
#include "common/environment.glsl"
#include "constants.glsl"
#include "common/tile_packing.glsl"
#include "sap/sample_allocation.glsl"

const uint lanes = 128u;
const uint run = tiles_per_run_group / lanes; // tiles of an invocation
layout(local_size_x = 128, local_size_y = 1, local_size_z = 1) in;

shared uint cost_of_bin[allocation_bins];

void main() {
  uint lane = gl_LocalInvocationIndex;
  for (uint bin = lane; bin < allocation_bins; bin += lanes)
    cost_of_bin[bin] = 0u;
  uint first = gl_WorkGroupID.x * tiles_per_run_group + lane;
  uint tiles = uint(frame.tiles.x * frame.tiles.y);
  uint tile_errors[run], before[run];
  [[unroll]] for (uint i = 0u; i < run; ++i) {
    uint tile = first + i * lanes, near = min(tile, tiles - 1u);
    uint entry = classes_data[near], tile_error = tile_errors_data[near];
    before[i] = has_before() ? before_data[previous_tile(near)] : 0u;
    tile_errors[i] = tile == near && class_of_tile(entry) == class_scatter ? tile_error : 0u;
  }
  barrier();
  [[unroll]] for (uint i = 0u; i < run; ++i) {
    if (tile_errors[i] == 0u)
      continue; // no bin
    for (int k = 0; k < allocation_steps; ++k)
      atomicAdd(cost_of_bin[step_bin(tile_errors[i], k, before[i])], step_cost(k));
  }
  barrier();
  for (uint bin = lane; bin < allocation_bins; bin += lanes)
    demand_data[gl_WorkGroupID.x * allocation_bins + bin] = cost_of_bin[bin];
}
