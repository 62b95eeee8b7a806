#version 460
// Computes the next finer level: blends its own light with the values of the coarser level by the
// profile's fractions. The four texels of a block share the four texels of the coarser level, which
// may have two layers.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "sap/subsurface_sap_up.bindings.glsl"
#include "common/environment.glsl"
#include "common/half.glsl"
#define SAP_COARSE_LAYERS 2
#define SAP_SECOND_MAY_LACK
#include "sap/sap_climb.glsl"

void main() {
  int level = settings.level;
  texel_block block;
  if (!listed_block(level, block))
    return;
  ivec2 first = block.first - 1;
  bool smooth_level = settings.variant == VARIANT_SMOOTH || level == 1, last = !has_coarse_scattered();
  read_ring(block, first, level, smooth_level);
  if (!last)
    read_coarser(first, level);
  [[unroll]] for (int k = 0; k < block_width * block_height; ++k) {
    ivec2 at = first + ivec2(k % block_width, k / block_width);
    if (!sap_inside(at, level))
      continue;
    take_near(k);
    if (!last)
      take_corners(k);
    uvec4 bits = uvec4(0u);
    sap_texel own = sap_unpack(near_surface[near_centre]);
    if (own.id != 0u)
      bits = climb(odd_of(k), level, own, near_light[near_centre].rgb, SAP_COARSE_LAYERS, smooth_level, last);
    imageStore(scattered_image, sap_address(at, level), bits);
  }
}
