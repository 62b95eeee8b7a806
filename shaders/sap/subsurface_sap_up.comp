#version 460
// Computes the next finer level: blends its own light with the values of the coarser level by the
// profile's fractions. Texels of the coarser level may have two layers.
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
  bool smooth_level = settings.variant == VARIANT_SMOOTH || level == 1,
       last = !has_coarse_scattered();
  read_ring(block, level, smooth_level);
  if (!last)
    read_coarser(block, level);
  finish_reading();
  [[unroll]] for (int k = 0; k < block_texels; ++k) {
    sap_place place = place_of(block, k);
    if (!sap_inside(place.at, level))
      continue;
    take_near(k);
    if (!last)
      take_corners(k);
    uvec4 bits = uvec4(0u);
    sap_texel own = sap_unpack(near_bits(place, near_centre));
    vec3 light = light_near(place, level, near_centre).rgb;
    if (own.id != 0u)
      bits = climb(place, level, own, light, SAP_COARSE_LAYERS, smooth_level, last);
    imageStore(scattered_image, sap_address(place.at, level), bits);
  }
}
