#version 460
// Computes the next finer level with two layers per texel: blends its own light with the values of
// the coarser level by the profile's fractions. First computes texels in groups of four. Then
// recomputes, one by one and from both layers, the texels that have a second layer themselves, next
// to them or in the coarser level.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "sap/subsurface_sap_up_layered.bindings.glsl"
#include "common/environment.glsl"
#include "common/half.glsl"
#define SAP_OWN_LAYERS 2
#define SAP_COARSE_LAYERS 2
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
  uint layered = 0u; // bit k: texel k needs more than one layer
  [[unroll]] for (int k = 0; k < block_width * block_height; ++k) {
    ivec2 at = first + ivec2(k % block_width, k / block_width);
    if (!sap_inside(at, level))
      continue;
    uint found = take_near(k);
    if (!last)
      found |= take_corners(k);
    layered |= (found & sap_second_bit) != 0u ? 1u << k : 0u;
    uvec4 bits = uvec4(0u);
    sap_texel own = sap_unpack(near_surface[near_centre]);
    if (own.id != 0u)
      bits = climb(odd_of(k), level, own, near_light[near_centre].rgb, 1, smooth_level, last);
    imageStore(scattered_image, sap_address(at, level), bits);
  }
  // The loops test at their end, because some drivers execute the body of a loop before they find
  // that no invocation is active.
  if (layered != 0u)
    do {
      int k = findLSB(layered);
      ivec2 offset = ivec2(k % block_width, k / block_width), at = first + offset;
      read_near(block, offset, at, level, smooth_level);
      read_corners(at, level, !last);
      vec3 light = near_light[near_centre].rgb;
      sap_texel own = sap_unpack(near_surface[near_centre]);
      int layer = 0, layers = sap_has_second(near_surface[near_centre]) ? 2 : 1;
      [[dont_unroll]] do {
        uvec4 bits = uvec4(0u);
        if (own.id != 0u)
          bits = climb(at & 1, level, own, light, SAP_OWN_LAYERS, smooth_level, last);
        if (layer == 0)
          imageStore(scattered_image, sap_address(at, level), bits);
        else
          imageStore(second_scattered_image, sap_address(at, level), bits);
        own = sap_unpack(near_surface[near_texels + near_centre]);
        light = near_light[near_texels + near_centre].rgb;
      } while (++layer < layers);
      layered &= layered - 1u;
    } while (layered != 0u);
}
