#version 460
// One group scans all tile classes and writes the list in row order, without atomics, so that equal
// classes give equal lists. Each invocation owns a run of consecutive tiles.
#extension GL_GOOGLE_include_directive : require
#include "common/subsurface_tile_list.bindings.glsl"
#include "common/environment.glsl"
#include "common/tile_packing.glsl"

const uint lanes = 256u;
layout(local_size_x = 256, local_size_y = 1, local_size_z = 1) in;

shared uint counts[lanes];

void main() {
  uint lane = gl_LocalInvocationIndex;
  uint total = uint(frame.tiles.x * frame.tiles.y);
  uint run = (total + lanes - 1u) / lanes;
  uint first = min(lane * run, total), last = min(first + run, total);

  uint own = 0u;
  for (uint i = first; i < last; ++i)
    own += class_of_tile(classes_data[i]) != class_none ? 1u : 0u;
  counts[lane] = own;
  barrier();
  for (uint stride = 1u; stride < lanes; stride *= 2u) { // inclusive scan, Hillis & Steele 1986
    uint before = lane >= stride ? counts[lane - stride] : 0u;
    barrier();
    counts[lane] += before;
    barrier();
  }

  uint at = counts[lane] - own;
  for (uint i = first; i < last; ++i) {
    uint entry = classes_data[i];
    if (class_of_tile(entry) == class_none)
      continue;
    uvec2 tile = uvec2(i % uint(frame.tiles.x), i / uint(frame.tiles.x));
    tiles_data[1u + at++] = pack_tile(tile, entry);
  }
  if (lane == lanes - 1u) {
    uint listed = counts[lane];
    tiles_data[0] = listed;
    arguments_data[0] = min(listed, tile_groups_per_row);
    arguments_data[1] = (listed + tile_groups_per_row - 1u) / tile_groups_per_row;
    arguments_data[2] = 1u;
  }
}
