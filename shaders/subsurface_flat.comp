#version 460
// A tile whose light is the same as far as light reaches keeps its own light: what scatters out of a pixel comes back
// from others. One group a tile looks at all tiles around it; its class alone changes, which no other group reads.
#extension GL_GOOGLE_include_directive : require
#include "subsurface_flat.bindings.glsl"
#include "environment.glsl"
#include "constants.glsl"
#include "counters.glsl"
#include "light_range.glsl"
#include "tile_packing.glsl"

layout(local_size_x = 8, local_size_y = 8, local_size_z = 1) in;

shared uint varied;

void main() {
  uint lane = gl_LocalInvocationIndex;
  ivec2 tile = ivec2(gl_WorkGroupID.xy);
  uint index = uint(tile.y * frame.tiles.x + tile.x);
  if (classes_data[index] != class_scatter) // the same for the whole group
    return;
  uvec4 own = light_range_data[index];
  vec3 low, high;
  unpack_range(own, low, high);
  float d_px = uintBitsToFloat(own.w);
  int reach = flat_reach(d_px);
  if (reach > flat_most_reach || !is_alike(own, low, high))
    return;
  if (lane == 0u)
    varied = 0u;
  barrier();
  ivec2 first = max(tile - reach, ivec2(0)), last = min(tile + reach, frame.tiles - 1);
  ivec2 size = last - first + 1;
  for (int i = int(lane); i < size.x * size.y; i += 64) {
    ivec2 other = first + ivec2(i % size.x, i / size.x);
    if (!is_alike(light_range_data[other.y * frame.tiles.x + other.x], low, high)) {
      atomicOr(varied, 1u);
      break;
    }
  }
  barrier();
  if (lane == 0u && varied == 0u) {
    classes_data[index] = class_flat;
    recount_as_flat(d_px);
  }
}
