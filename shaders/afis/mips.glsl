// Filtered reads of the masked mip chain at the position of a sample. Include after bindings with
// level_1 .. level_8 and `settings`.
#ifndef DERMIS_MIPS_GLSL
#define DERMIS_MIPS_GLSL

#include "afis/pyramid.glsl"

const float last_mip = 8.0;

vec4 mip_read(int level, vec2 pixel) {
  vec2 at = (pixel + 0.5) * exp2(-float(level)) - 0.5;
  switch (level) {
  case 1: return pyramid_read(level_1_image, at);
  case 2: return pyramid_read(level_2_image, at);
  case 3: return pyramid_read(level_3_image, at);
  case 4: return pyramid_read(level_4_image, at);
  case 5: return pyramid_read(level_5_image, at);
  case 6: return pyramid_read(level_6_image, at);
  case 7: return pyramid_read(level_7_image, at);
  default: return pyramid_read(level_8_image, at);
  }
}

// Returns the mean light around `pixel` at a level of detail. Returns `nearest`, the light of the
// pixel itself, at level 0 and if the mean would include another profile.
vec3 filtered_light(vec2 pixel, float lod, vec3 nearest) {
  lod = clamp(lod, 0.0, last_mip);
  if (settings.mips == MIPS_WHOLE)
    lod = round(lod);
  int level = int(lod);
  float part = lod - float(level);
  vec4 mean = level == 0 ? vec4(nearest, apart_scale) : mip_read(level, pixel);
  if (mean.a > mixed_above)
    return nearest;
  if (part > 0.0) {
    vec4 coarser = mip_read(level + 1, pixel);
    if (coarser.a > mixed_above)
      return nearest;
    mean = mix(mean, coarser, part);
  }
  return mean.a < 1e-3 * apart_scale ? nearest : mean.rgb * (apart_scale / mean.a);
}

#endif
