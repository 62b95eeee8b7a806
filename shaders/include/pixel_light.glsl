// A pixel's own light that can scatter. Include after bindings with `lighting`, `albedo` and the setting `texturing`.
#ifndef DERMIS_PIXEL_LIGHT_GLSL
#define DERMIS_PIXEL_LIGHT_GLSL

#include "sanitise.glsl"

// What `texturing` does to light on its way in.
vec3 texture_light(ivec2 texel, vec3 light) {
  if (settings.texturing == TEXTURING_POST || !has_albedo())
    return light;
  vec3 albedo = clean_albedo(texelFetch(albedo_image, texel, 0).rgb);
  return light * (settings.texturing == TEXTURING_PRE ? albedo : sqrt(albedo));
}

vec3 pixel_light(ivec2 texel) { return texture_light(texel, clean_light(texelFetch(lighting_image, texel, 0).rgb)); }

#endif
