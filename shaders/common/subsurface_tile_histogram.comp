#version 460
// Each workgroup reads a range of tiles in row order and writes two histograms of their importance
// (expected change of a pixel): one of all scattering tiles, and one of those that the selection
// may leave out.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "common/subsurface_tile_histogram.bindings.glsl"
#include "common/environment.glsl"
#include "constants.glsl"
#include "common/tile_selection.glsl"

const uint lanes = 128u;
const uint run = tiles_per_run_group / lanes; // tiles of an invocation
layout(local_size_x = 128, local_size_y = 1, local_size_z = 1) in;

shared uint tiles_of_bin[2u * selection_bins];

void main() {
  uint lane = gl_LocalInvocationIndex;
  for (uint bin = lane; bin < 2u * selection_bins; bin += lanes)
    tiles_of_bin[bin] = 0u;
  uint first = gl_WorkGroupID.x * tiles_per_run_group + lane;
  uint tiles = uint(frame.tiles.x * frame.tiles.y);
  uint bins[run];
  bool kept[run];
  [[unroll]] for (uint i = 0u; i < run; ++i) {
    uint tile = first + i * lanes, near = min(tile, tiles - 1u);
    uint priority = tile_changes_data[near];
    uint bin = selection_bin(classes_data[near], priority);
    kept[i] = is_kept(priority);
    bins[i] = tile == near ? bin : no_bin;
  }
  barrier();
  [[unroll]] for (uint i = 0u; i < run; ++i) {
    if (bins[i] == no_bin)
      continue;
    atomicAdd(tiles_of_bin[bins[i]], 1u);
    if (!kept[i])
      atomicAdd(tiles_of_bin[selection_bins + bins[i]], 1u);
  }
  barrier();
  for (uint bin = lane; bin < 2u * selection_bins; bin += lanes)
    histogram_data[gl_WorkGroupID.x * 2u * selection_bins + bin] = tiles_of_bin[bin];
}
