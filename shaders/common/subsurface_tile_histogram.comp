#version 460
// Counts the tiles that scatter by bin of their expected change, for a run of tiles in row order
// per group: all of them, then those without a weight in the previous frame.
#extension GL_GOOGLE_include_directive : require
#include "common/subsurface_tile_histogram.bindings.glsl"
#include "common/environment.glsl"
#include "constants.glsl"
#include "common/reproject.glsl"
#include "common/tile_selection.glsl"

const uint lanes = 128u;
layout(local_size_x = 128, local_size_y = 1, local_size_z = 1) in;

shared uint tiles_of_bin[2u * selection_bins];

void main() {
  uint lane = gl_LocalInvocationIndex;
  bool continues = has_before() && history_usable();
  for (uint bin = lane; bin < 2u * selection_bins; bin += lanes)
    tiles_of_bin[bin] = 0u;
  barrier();
  uint first = gl_WorkGroupID.x * tiles_per_run_group;
  uint last = min(first + tiles_per_run_group, uint(frame.tiles.x * frame.tiles.y));
  for (uint tile = first + lane; tile < last; tile += lanes) {
    uint before = continues ? before_data[tile] : 0u;
    uint bin = selection_bin(classes_data[tile], tile_changes_data[tile], before);
    if (bin == no_bin)
      continue;
    atomicAdd(tiles_of_bin[bin], 1u);
    if (!is_chosen(before))
      atomicAdd(tiles_of_bin[selection_bins + bin], 1u);
  }
  barrier();
  for (uint bin = lane; bin < 2u * selection_bins; bin += lanes)
    histogram_data[gl_WorkGroupID.x * 2u * selection_bins + bin] = tiles_of_bin[bin];
}
