#version 460
// One group a tile: has it subsurface, and does any pixel of it scatter further than itself? Counts tiles: sums of
// integers, which no order changes. Tells between which values the light lies that can scatter, too.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "subsurface_classify.bindings.glsl"
#include "environment.glsl"
#include "constants.glsl"
#include "counters.glsl"
#include "half.glsl"
#include "light_range.glsl"
#include "radius.glsl"
#include "sanitise.glsl"
#include "tile_packing.glsl"

layout(local_size_x = 8, local_size_y = 8, local_size_z = 1) in;

shared uint found;
shared uint widest_bits; // of the largest d in pixels: floats from 0 on are ordered as their bits are
shared vec3 held[64];    // light by pixel; x < 0: none
shared vec3 row_low[8], row_high[8];

vec3 light_of(ivec2 texel) {
  vec3 light = clean_light(texelFetch(lighting_image, texel, 0).rgb);
  if (settings.texturing != TEXTURING_POST && has_albedo()) {
    vec3 albedo = clean_albedo(texelFetch(albedo_image, texel, 0).rgb);
    light *= settings.texturing == TEXTURING_PRE ? albedo : sqrt(albedo);
  }
  return round_to_half(light);
}

// Of eight pixels that lie one after the other.
void reduce_row(uint row) {
  vec3 low = vec3(largest_half), high = vec3(0.0);
  for (uint i = 8u * row; i < 8u * row + 8u; ++i)
    if (held[i].x >= 0.0) {
      low = min(low, held[i]);
      high = max(high, held[i]);
    }
  row_low[row] = low;
  row_high[row] = high;
}

uvec4 range_of_tile(float d_px) {
  vec3 low = row_low[0], high = row_high[0];
  for (uint row = 1u; row < 8u; ++row) {
    low = min(low, row_low[row]);
    high = max(high, row_high[row]);
  }
  return pack_range(low, high, d_px);
}

void main() {
  uint lane = gl_LocalInvocationIndex;
  if (lane == 0u) {
    found = 0u;
    widest_bits = 0u;
  }
  barrier();
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  bool ranged = has_light_range() && has_lighting();
  vec3 light = vec3(-1.0);
  if (inside_rect(pixel) && inside_bounds(pixel)) {
    ivec2 texel = texel_of(pixel);
    uint id = texelFetch(material_image, texel, 0).r;
    if (id != 0u) {
      float depth = view_depth(texelFetch(depth_image, texel, 0).r);
      float scale = has_scatter_scale() ? clean_scatter_scale(texelFetch(scatter_scale_image, texel, 0).r) : 1.0;
      float d_px = depth > 0.0 ? projected_d(profiles[min(id, 255u)].d_mm.w * scale, depth) : 0.0;
      atomicOr(found, d_px >= copy_below_d_px ? class_scatter : class_copy);
      if (d_px >= copy_below_d_px)
        atomicMax(widest_bits, floatBitsToUint(d_px));
      if (ranged)
        light = light_of(texel);
    }
  }
  if (ranged)
    held[lane] = light;
  barrier();
  if (ranged) {
    if (lane < 8u)
      reduce_row(lane);
    barrier();
  }
  if (lane == 0u) {
    uint tile = gl_WorkGroupID.y * uint(frame.tiles.x) + gl_WorkGroupID.x;
    classes_data[tile] = (found & class_scatter) != 0u ? class_scatter : found;
    if (ranged)
      light_range_data[tile] = range_of_tile(uintBitsToFloat(widest_bits));
    if ((found & class_scatter) != 0u)
      count_scattering_tile(uintBitsToFloat(widest_bits));
    else if (found != class_none)
      atomicAdd(counters.copied_tiles, 1u);
  }
}
