#version 460
// Lists the tiles with subsurface and writes the arguments of indirect dispatches over them. An
// invocation appends a run of consecutive tiles, and a group all its runs with one atomic
// operation.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "common/subsurface_tile_list.bindings.glsl"
#include "common/environment.glsl"
#include "constants.glsl"
#include "common/list_state.glsl"
#include "common/tile_packing.glsl"

const uint run = tiles_per_run_group / 128u;
layout(local_size_x = 128, local_size_y = 1, local_size_z = 1) in;

shared uint listed; // tiles of the group
shared uint base;   // index of the first of them in the list

// Returns whether this group is the last to call the function, for one invocation of each group.
// The invocation's earlier atomic operations on `list_state` are then visible to the last one.
bool ends_last() {
  memoryBarrierBuffer();
  bool last = atomicAdd(list_state_data[state_ended], 1u) + 1u == list_groups();
  memoryBarrierBuffer();
  return last;
}

void write_arguments() {
  uint all = atomicExchange(list_state_data[0], 0u);
  list_state_data[state_ended] = 0u;
  tiles_data[0] = all;
  arguments_data[0] = min(all, tile_groups_per_row);
  arguments_data[1] = (all + tile_groups_per_row - 1u) / tile_groups_per_row;
  arguments_data[2] = 1u;
}

void main() {
  uint lane = gl_LocalInvocationIndex;
  uint total = uint(frame.tiles.x * frame.tiles.y);
  uint first = gl_WorkGroupID.x * tiles_per_run_group + lane * run;
  if (lane == 0u)
    listed = 0u;
  uint entries[run];
  uint own = 0u;
  [[unroll]] for (uint i = 0u; i < run; ++i) {
    uint entry = classes_data[min(first + i, total - 1u)];
    entries[i] = first + i < total ? entry : class_none;
    own += class_of_tile(entries[i]) != class_none ? 1u : 0u;
  }
  barrier();
  uint at = own > 0u ? atomicAdd(listed, own) : 0u;
  barrier();
  if (lane == 0u && listed > 0u)
    base = atomicAdd(list_state_data[0], listed);
  barrier();
  if (lane == 0u && ends_last())
    write_arguments();
  at += base;
  uint across = uint(frame.tiles.x);
  uvec2 tile = uvec2(first % across, first / across);
  [[unroll]] for (uint i = 0u; i < run; ++i) {
    if (class_of_tile(entries[i]) != class_none)
      tiles_data[1u + at++] = pack_tile(tile, entries[i]);
    tile = tile.x + 1u < across ? tile + uvec2(1u, 0u) : uvec2(0u, tile.y + 1u);
  }
}
