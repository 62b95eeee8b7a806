// The light that the host shows: scattered light after albedo, or only scattered light.
#ifndef DERMIS_COMBINED_LIGHT_GLSL
#define DERMIS_COMBINED_LIGHT_GLSL

#extension GL_EXT_samplerless_texture_functions : require

#include "common/half.glsl"
#include "common/sanitise.glsl"
#include "common/texturing.glsl"

// Returns the texel's albedo; 1 if `texturing` and `result` do not need it.
vec3 combined_albedo(texture2D albedo, bool albedo_bound, int texturing, int result, ivec2 texel) {
  if (!albedo_bound || result != RESULT_COLOR && texturing == TEXTURING_POST)
    return vec3(1.0);
  return clean_albedo(texelFetch(albedo, texel, 0).rgb);
}

// Returns the value that is written to 'lighting'.
vec4 combined_light(int texturing, int result, vec3 albedo, vec3 scattered) {
  if (result == RESULT_COLOR)
    scattered = apply_albedo_after(texturing, albedo, scattered);
  return vec4(round_to_half(scattered), 1.0);
}

#endif
