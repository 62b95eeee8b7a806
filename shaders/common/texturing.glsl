// Applies albedo before or after scattering, as the setting `texturing` says.
#ifndef DERMIS_TEXTURING_GLSL
#define DERMIS_TEXTURING_GLSL

#include "options.glsl"

// Lower bound of albedo in divisions, because light divided by almost no albedo is unreliable. Both
// sides of scattering use the same bound, so that light that does not scatter is restored exactly.
const float demodulation_floor = 1.0 / 64.0;

vec3 apply_albedo_before(int texturing, vec3 albedo, vec3 light) {
  if (texturing == TEXTURING_DEMODULATE)
    return light / max(albedo, vec3(demodulation_floor));
  if (texturing == TEXTURING_POST)
    return light;
  return light * (texturing == TEXTURING_PRE ? albedo : sqrt(albedo));
}

vec3 apply_albedo_after(int texturing, vec3 albedo, vec3 light) {
  if (texturing == TEXTURING_DEMODULATE)
    return light * max(albedo, vec3(demodulation_floor));
  if (texturing == TEXTURING_PRE)
    return light;
  return light * (texturing == TEXTURING_POST ? albedo : sqrt(albedo));
}

#endif
