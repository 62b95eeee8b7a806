// Filtered reads of the masked mip chain at the position of a sample.
#ifndef DERMIS_MIPS_GLSL
#define DERMIS_MIPS_GLSL

#include "afis/pyramid.glsl"
#include "options.glsl"

const float last_mip = 8.0;

// Returns the mean light around `pixel` at a level of detail, as the setting `mips` says. Returns
// `nearest`, the light of the pixel itself, at level 0 and if the mean would include another
// profile. Mip 0 of `levels` is level 1, so that a sample is one read.
vec3 filtered_light(texture2D levels, int mips, vec2 pixel, float lod, vec3 nearest) {
  lod = clamp(lod, 0.0, last_mip);
  if (mips == MIPS_WHOLE)
    lod = round(lod);
  if (lod <= 0.0)
    return nearest;
  vec2 place = 0.5 * (pixel + 0.5) / vec2(textureSize(levels, 0));
  vec4 mean = textureLod(sampler2D(levels, linear_sampler), place, lod - 1.0);
  if (mean.a > mixed_above)
    return nearest;
  mean = mix(vec4(nearest, apart_scale), mean, min(lod, 1.0));
  return mean.a < 1e-3 * apart_scale ? nearest : mean.rgb * (apart_scale / mean.a);
}

#endif
