// The last step up: scattered light and confidence of a pixel. Include after the bindings listed in
// sap_up.glsl, and after the ports and settings of the last step.
#ifndef DERMIS_SAP_GATHER_GLSL
#define DERMIS_SAP_GATHER_GLSL

const int block_width = 4, block_height = 2, coarse_width = 4, coarse_height = 3, border = 0;
#include "common/combined_light.glsl"
#include "sap/sap_up.glsl"

const float min_fraction = 0.002; // the tent is not worth its time for a smaller weight

// Returns the light of the texel at `place`, whose own light is `centre_light`.
vec4 gather(sap_place place, sap_texel own, vec4 centre_light) {
  vec3 light = centre_light.rgb;
  // a tilted pixel keeps more of its own light
  vec3 d_px = sap_d_px(own) * inversesqrt(centre_light.a);
  vec3 centre, tent;
  sap_weights_of_level_0(own.id, settings.variant, d_px, centre, tent);
  sap_sum near = sap_sum(light, vec3(1.0));
  if (max(tent.r, max(tent.g, tent.b)) >= min_fraction)
    near = sap_tent(place, 0, own, 1);
  float confidence;
  sap_sum rest = sap_from_coarser(place, 0, own, light, SAP_COARSE_LAYERS, confidence);
  rest.mass *= max(1.0 - centre - tent, vec3(0.0));
  uint widest = profiles[min(own.id, 255u)].widest;
  confidence = mix(confidence, 1.0, centre[widest] + tent[widest]); // level 0 misses nothing
  // Light that never scatters needs no surface around.
  vec3 direct = profile_direct(own.id);
  vec3 mean = sap_blend(max(centre - direct, vec3(0.0)), light, tent * near.mass,
                        near.light, rest)
                  .light;
  return vec4(mix(mean, light, direct), confidence);
}

// Writes the result of a pixel to the bound ports.
void write_result(ivec2 pixel, sap_texel own, vec4 result) {
  ivec2 texel = texel_of(pixel);
  if (settings.storage != STORAGE_FULL)
    result = round_to_half(result);
  if (has_scattered())
    imageStore(scattered_image, texel, result);
  if (has_lighting() && sap_has_subsurface(own)) {
    vec3 albedo =
        combined_albedo(albedo_image, has_albedo(), settings.texturing, settings.result, texel);
    imageStore(lighting_image, texel,
               combined_light(settings.texturing, settings.result, albedo, result.rgb));
  }
  if (has_unscattered() && has_scattered_light() && own.id != 0u) {
    vec4 before = texelFetch(unscattered_image, texel, 0);
    vec3 d = profiles[min(own.id, 255u)].d_mm.rgb;
    if (before.a == 0.0)
      imageStore(scattered_light_image, texel,
                 vec4(mix(before.rgb, result.rgb, greaterThan(d, vec3(0.0))), 1.0));
  }
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
    sap_place place = place_of(block, k, 0);
    if (!inside_rect(place.at))
      continue;
    take_near(k);
    vec4 light = light_near(place, 0, near_centre);
    vec4 result = vec4(light.rgb, 1.0);
    sap_texel own = sap_unpack(near_bits(place, near_centre));
    if (!block.copy_only && own.id != 0u) {
      take_corners(k, 0);
      result = gather(place, own, light);
    }
    write_result(place.at, own, result);
  }
}

#endif
