// The light of a pixel that can scatter. Include after bindings with `lighting`, `albedo` and the
// setting `texturing`.
#ifndef DERMIS_PIXEL_LIGHT_GLSL
#define DERMIS_PIXEL_LIGHT_GLSL

#include "common/sanitise.glsl"
#include "common/texturing.glsl"

// Applies the part of albedo that `texturing` applies before scattering.
vec3 texture_light(ivec2 texel, vec3 light) {
  if (settings.texturing == TEXTURING_POST || !has_albedo())
    return light;
  return clean_light(apply_albedo_before(settings.texturing, clean_albedo(texelFetch(albedo_image, texel, 0).rgb), light));
}

vec3 pixel_light(ivec2 texel) { return texture_light(texel, clean_light(texelFetch(lighting_image, texel, 0).rgb)); }

#endif
