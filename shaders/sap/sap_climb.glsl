// One step up, for one texel. Include after the bindings listed in sap_up.glsl, with `variant` and
// `storage`.
#ifndef DERMIS_SAP_CLIMB_GLSL
#define DERMIS_SAP_CLIMB_GLSL

const int block_width = 2, block_height = 2, coarse_width = 2, coarse_height = 2, border = 1;
#include "sap/sap_up.glsl"

const float min_fraction = 0.004; // the tent is not worth its time for a smaller weight

// Returns the bits of the texel at `place`, blended with the values of the coarser level. `layers`:
// number of layers to read.
uvec4 climb(sap_place place, int level, sap_texel own, vec3 light, int layers, bool smooth_level,
            bool last) {
  vec3 fraction = last ? vec3(1.0) : sap_lookup(own.id, settings.variant, level + 1, sap_d_px(own));
  float mass = own.mass; // of all channels
  if (smooth_level && max(fraction.r, max(fraction.g, fraction.b)) >= min_fraction) {
    sap_sum tent = sap_tent(place, level, own, layers);
    light = tent.light;
    mass = tent.mass.r;
  }
  float confidence = 1.0; // without coarser levels nothing is missing in them
  sap_sum rest = sap_sum(light, vec3(0.0));
  if (!last)
    rest = sap_from_coarser(place, level, own, light, layers, confidence);
  rest.mass *= max(1.0 - fraction, vec3(0.0));
  sap_sum blend = sap_blend(fraction * mass, light, vec3(0.0), light, rest);
  float widest = fraction[profiles[min(own.id, 255u)].widest];
  confidence = mix(confidence, 1.0 - sap_not_held(own), widest);
  return settings.storage == STORAGE_FULL
             ? sap_pack_scattered_full(sap_scattered(blend.light, confidence, blend.mass))
             : sap_pack_scattered(sap_scattered(round_to_half(blend.light),
                                                round_to_half(confidence),
                                                round_to_half(blend.mass)));
}

#endif
