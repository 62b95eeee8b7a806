// Filtered reads of the masked mip chain at the position of a sample. The levels are separate
// textures, so each of them is a parameter.
#ifndef DERMIS_MIPS_GLSL
#define DERMIS_MIPS_GLSL

#include "afis/pyramid.glsl"
#include "options.glsl"

const float last_mip = 8.0;

vec4 mip_read(texture2D level_1, texture2D level_2, texture2D level_3, texture2D level_4,
              texture2D level_5, texture2D level_6, texture2D level_7, texture2D level_8, int level,
              vec2 pixel) {
  vec2 at = (pixel + 0.5) * exp2(-float(level)) - 0.5;
  switch (level) {
  case 1: return pyramid_read(level_1, at);
  case 2: return pyramid_read(level_2, at);
  case 3: return pyramid_read(level_3, at);
  case 4: return pyramid_read(level_4, at);
  case 5: return pyramid_read(level_5, at);
  case 6: return pyramid_read(level_6, at);
  case 7: return pyramid_read(level_7, at);
  default: return pyramid_read(level_8, at);
  }
}

// Returns the mean light around `pixel` at a level of detail, as the setting `mips` says. Returns
// `nearest`, the light of the pixel itself, at level 0 and if the mean would include another
// profile.
vec3 filtered_light(texture2D level_1, texture2D level_2, texture2D level_3, texture2D level_4,
                    texture2D level_5, texture2D level_6, texture2D level_7, texture2D level_8,
                    int mips, vec2 pixel, float lod, vec3 nearest) {
  lod = clamp(lod, 0.0, last_mip);
  if (mips == MIPS_WHOLE)
    lod = round(lod);
  int level = int(lod);
  float part = lod - float(level);
  vec4 mean = vec4(nearest, apart_scale);
  if (level != 0)
    mean = mip_read(level_1, level_2, level_3, level_4, level_5, level_6, level_7, level_8, level,
                    pixel);
  if (mean.a > mixed_above)
    return nearest;
  if (part > 0.0) {
    vec4 coarser = mip_read(level_1, level_2, level_3, level_4, level_5, level_6, level_7, level_8,
                            level + 1, pixel);
    if (coarser.a > mixed_above)
      return nearest;
    mean = mix(mean, coarser, part);
  }
  return mean.a < 1e-3 * apart_scale ? nearest : mean.rgb * (apart_scale / mean.a);
}

#endif
