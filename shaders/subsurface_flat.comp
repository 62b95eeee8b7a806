#version 460
// A tile whose light is the same as far as light reaches keeps its own light: what scatters out of a pixel comes back
// from others. One invocation a tile, which looks at the tiles around it until one differs; its class alone changes, which
// no other invocation reads.
#extension GL_GOOGLE_include_directive : require
#include "subsurface_flat.bindings.glsl"
#include "environment.glsl"
#include "constants.glsl"
#include "counters.glsl"
#include "light_range.glsl"
#include "tile_packing.glsl"

layout(local_size_x = 64, local_size_y = 1, local_size_z = 1) in;

// Is the light of all tiles from `first` to `last` that of one between `low` and `high`?
bool all_alike(ivec2 first, ivec2 last, vec3 low, vec3 high) {
  for (int y = first.y; y <= last.y; ++y)
    for (int x = first.x; x <= last.x; ++x)
      if (!is_alike(light_range_data[y * frame.tiles.x + x], low, high))
        return false;
  return true;
}

void main() {
  int index = int(gl_GlobalInvocationID.x);
  if (index >= frame.tiles.x * frame.tiles.y || classes_data[index] != class_scatter)
    return;
  uvec4 own = light_range_data[index];
  vec3 low, high;
  unpack_range(own, low, high);
  float d_px = uintBitsToFloat(own.w);
  int reach = flat_reach(d_px);
  if (reach > flat_most_reach || !is_alike(own, low, high))
    return;
  ivec2 tile = ivec2(index % frame.tiles.x, index / frame.tiles.x);
  if (!all_alike(max(tile - reach, ivec2(0)), min(tile + reach, frame.tiles - 1), low, high))
    return;
  classes_data[index] = class_flat;
  recount_as_flat(d_px);
}
