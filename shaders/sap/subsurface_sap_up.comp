#version 460
// Computes the next finer level with two layers per texel: blends its own light with the values of
// the coarser level by the profile's fractions. The block shape first computes one layer of all
// texels. Then it recomputes, one by one and from both layers, the texels that have a second layer
// themselves, next to them or in the coarser level.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "sap/subsurface_sap_up.bindings.glsl"
#include "common/environment.glsl"
#include "common/half.glsl"
#define SAP_OWN_LAYERS 2
#define SAP_COARSE_LAYERS 2
#include "sap/sap_climb.glsl"

void store_scattered(sap_place place, int level, int layer, uvec4 bits) {
  if (layer == 0)
    imageStore(scattered_image, sap_address(place.at, level), bits);
  else
    imageStore(second_scattered_image, sap_address(place.at, level), bits);
}
#include "sap/sap_up_layers.glsl"

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
  if (texel_shape) {
    sap_place place = place_of(block, 0, level);
    if (sap_inside(place.at, level))
      compute_layers(place, level, smooth_level, last);
    return;
  }
  uint layered = 0u; // bit k: texel k needs more than one layer
  [[unroll]] for (int k = 0; k < block_width * block_height; ++k) {
    sap_place place = place_of(block, k, level);
    if (!sap_inside(place.at, level))
      continue;
    uint found = take_near(k);
    if (!last)
      found |= take_corners(k, level);
    layered |= (found & sap_second_bit) != 0u ? 1u << k : 0u;
    uvec4 bits = uvec4(0u);
    sap_texel own = sap_unpack(near_bits(place, near_centre));
    if (own.id != 0u)
      bits = climb(place, level, own, light_near(place, level, near_centre).rgb, 1, smooth_level,
                   last);
    imageStore(scattered_image, sap_address(place.at, level), bits);
  }
  if (layered != 0u)
    do {
      ivec2 offset = block_offset(findLSB(layered)), at = block.first - border + offset;
      read_near(block, block.first + offset, level, smooth_level);
      read_corners(at, level, !last);
      compute_layers(sap_place(at, at & 1, 0, 0), level, smooth_level, last);
      layered &= layered - 1u;
    } while (layered != 0u);
}
