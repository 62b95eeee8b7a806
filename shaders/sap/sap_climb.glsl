// One step up, for both layers of a texel.
#ifndef DERMIS_SAP_CLIMB_GLSL
#define DERMIS_SAP_CLIMB_GLSL

#include "sap/sap_up.glsl"

const float min_fraction = 0.004; // the tent is not worth its time for a smaller weight

// How to compute a level.
struct sap_step {
  int level;
  int variant;       // setting
  bool smooth_level; // with a tent
  bool last;         // there is no coarser level
};

// Returns the bits of the texel at `place`, blended with the values of the coarser level. `layers`:
// number of layers to read.
uvec4 climb(sap_step how, sap_place place, sap_texel own, vec3 light, int layers) {
  vec3 fraction =
      how.last ? vec3(1.0) : sap_lookup(own.id, how.variant, how.level + 1, sap_d_px(own));
  float mass = own.mass; // of all channels
  if (how.smooth_level && max(fraction.r, max(fraction.g, fraction.b)) >= min_fraction) {
    sap_sum tent = sap_tent(place, how.level, own, layers);
    light = tent.light;
    mass = tent.mass.r;
  }
  float confidence = 1.0; // without coarser levels nothing is missing in them
  sap_sum rest = sap_sum(light, vec3(0.0));
  if (!how.last)
    rest = sap_from_coarser(place, how.level, own, light, layers, confidence);
  rest.mass *= max(1.0 - fraction, vec3(0.0));
  sap_sum blend = sap_blend(fraction * mass, light, vec3(0.0), light, rest);
  float widest = fraction[profiles[min(own.id, 255u)].widest];
  confidence = mix(confidence, 1.0 - sap_not_held(own), widest);
  return stores_full() ? sap_pack_scattered_full(
                             sap_scattered(blend.light, confidence, blend.mass))
                       : sap_pack_scattered(sap_scattered(round_to_half(blend.light),
                                                          round_to_half(confidence),
                                                          round_to_half(blend.mass)));
}

// Stores the bits of a layer of the texel at `place`. The kernel that includes this file defines
// the function.
void store_scattered(sap_place place, int level, int layer, uvec4 bits);

// Computes the layers of the texel at `place`. The loop tests at its end, because some drivers
// execute the body of a loop before they find that no invocation is active.
void compute_layers(sap_step how, sap_place place) {
  uvec4 first = near_surface(place, ivec2(0), 0);
  sap_texel own = sap_unpack(first);
  vec3 light = near_light(place, how.level, ivec2(0), 0).rgb;
  int layer = 0, layers = has_second_near(first) ? 2 : 1;
  [[dont_unroll]] do {
    uvec4 bits = uvec4(0u);
    if (own.id != 0u)
      bits = climb(how, place, own, light, 2);
    store_scattered(place, how.level, layer, bits);
    if (!branches_on_layers() || layers > 1) {
      own = sap_unpack(near_surface(place, ivec2(0), 1));
      light = near_light(place, how.level, ivec2(0), 1).rgb;
    }
  } while (++layer < layers);
}

#endif
