// The last step up: scattered light and confidence of a pixel. Include after the bindings listed in
// sap_up.glsl.
#ifndef DERMIS_SAP_GATHER_GLSL
#define DERMIS_SAP_GATHER_GLSL

const int block_width = 4, block_height = 2, coarse_width = 4, coarse_height = 3, border = 0;
#include "sap/sap_up.glsl"

const float min_fraction = 0.002; // the tent is not worth its time for a smaller weight

// Returns the light of the texel at `place`, whose own light is `centre_light`.
vec4 gather(sap_place place, sap_texel own, vec4 centre_light) {
  vec3 light = centre_light.rgb;
  // a tilted pixel keeps more of its own light
  vec3 d_px = sap_d_px(own) * inversesqrt(centre_light.a);
  vec3 centre = sap_lookup(own.id, settings.variant, 0, d_px),
       tent = sap_lookup(own.id, settings.variant, 1, d_px);
  sap_sum near = sap_sum(light, vec3(own.mass));
  if (max(tent.r, max(tent.g, tent.b)) >= min_fraction)
    near = sap_tent(place, 0, own, 1);
  float confidence;
  sap_sum rest = sap_from_coarser(place, 0, own, light, SAP_COARSE_LAYERS, confidence);
  rest.mass *= max(1.0 - centre - tent, vec3(0.0));
  uint widest = profiles[min(own.id, 255u)].widest;
  confidence =
      mix(confidence, 1.0, centre[widest] + tent[widest]) - tent[widest] * (1.0 - near.mass.r);
  // Light that never scatters needs no surface around.
  vec3 direct = profile_direct(own.id);
  vec3 mean = sap_blend(max(centre - direct, vec3(0.0)) * own.mass, light, tent * near.mass,
                        near.light, rest)
                  .light;
  return vec4(mix(mean, light, direct), confidence);
}

// Computes every pixel of the invocation's block.
void gather_block() {
  texel_block block;
  if (!listed_block(0, block))
    return;
  read_ring(block, 0, !block.copy_only);
  if (!block.copy_only)
    read_coarser(block, 0);
  finish_reading();
  [[unroll]] for (int k = 0; k < block_texels; ++k) {
    sap_place place = place_of(block, k);
    if (!inside_rect(place.at))
      continue;
    take_near(k);
    vec4 light = light_near(place, 0, near_centre);
    vec4 result = vec4(light.rgb, 1.0);
    sap_texel own = sap_unpack(near_bits(place, near_centre));
    if (!block.copy_only && own.id != 0u) {
      take_corners(k);
      result = gather(place, own, light);
    }
    imageStore(scattered_image, texel_of(place.at),
               settings.storage == STORAGE_FULL ? result : round_to_half(result));
  }
}

#endif
