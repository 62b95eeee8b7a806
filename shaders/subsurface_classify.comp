#version 460
// One group a tile: has it subsurface, and does any pixel of it scatter further than itself? Counts tiles: sums of
// integers, which no order changes.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "subsurface_classify.bindings.glsl"
#include "environment.glsl"
#include "constants.glsl"
#include "counters.glsl"
#include "radius.glsl"
#include "tile_packing.glsl"

layout(local_size_x = 8, local_size_y = 8, local_size_z = 1) in;

shared uint found;
shared uint widest_bits; // of the largest d in pixels: floats from 0 on are ordered as their bits are

void main() {
  if (gl_LocalInvocationIndex == 0u) {
    found = 0u;
    widest_bits = 0u;
  }
  barrier();
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (inside_rect(pixel)) {
    ivec2 texel = texel_of(pixel);
    uint id = texelFetch(material_image, texel, 0).r;
    if (id != 0u) {
      float depth = view_depth(texelFetch(depth_image, texel, 0).r);
      float scale = has_scatter_scale() ? clean_scatter_scale(texelFetch(scatter_scale_image, texel, 0).r) : 1.0;
      float d_px = depth > 0.0 ? projected_d(profiles[min(id, 255u)].d_mm.w * scale, depth) : 0.0;
      atomicOr(found, d_px >= copy_below_d_px ? class_scatter : class_copy);
      if (d_px >= copy_below_d_px)
        atomicMax(widest_bits, floatBitsToUint(d_px));
    }
  }
  barrier();
  if (gl_LocalInvocationIndex == 0u) {
    uint tile = gl_WorkGroupID.y * uint(frame.tiles.x) + gl_WorkGroupID.x;
    classes_data[tile] = (found & class_scatter) != 0u ? class_scatter : found;
    if ((found & class_scatter) != 0u)
      count_scattering_tile(uintBitsToFloat(widest_bits));
    else if (found != class_none)
      atomicAdd(counters.copied_tiles, 1u);
  }
}
