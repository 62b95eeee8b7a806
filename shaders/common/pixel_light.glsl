// The light of a pixel that can scatter.
#ifndef DERMIS_PIXEL_LIGHT_GLSL
#define DERMIS_PIXEL_LIGHT_GLSL

#extension GL_EXT_samplerless_texture_functions : require

#include "common/sanitise.glsl"
#include "common/texturing.glsl"

// Applies the part of albedo that `texturing` applies before scattering. `albedo` is not read
// unless `albedo_bound`.
vec3 texture_light(texture2D albedo, bool albedo_bound, int texturing, ivec2 texel, vec3 light) {
  if (texturing == TEXTURING_POST || !albedo_bound)
    return light;
  return clean_light(
      apply_albedo_before(texturing, clean_albedo(texelFetch(albedo, texel, 0).rgb), light));
}

vec3 pixel_light(texture2D lighting, texture2D albedo, bool albedo_bound, int texturing,
                 ivec2 texel) {
  vec3 light = clean_light(texelFetch(lighting, texel, 0).rgb);
  return texture_light(albedo, albedo_bound, texturing, texel, light);
}

#endif
