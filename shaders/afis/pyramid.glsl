// Images of the plain pyramid: level l has a texel every 2^l pixels of the rectangle, and a border
// of two texels unless the levels are mips of an image.
#ifndef DERMIS_PYRAMID_GLSL
#define DERMIS_PYRAMID_GLSL

#extension GL_EXT_samplerless_texture_functions : require

#include "common/environment.glsl"
#include "common/half.glsl"

layout(set = 1, binding = 3) uniform sampler linear_sampler;

const int pyramid_border = 2;

// Chains that keep profiles apart store masks scaled by `apart_scale`. A pixel next to another
// profile has `mixed_mask`, which spreads to every texel that the pixel contributes to. Filtered
// reads between levels have weights of at least 2^-24 (8 bits per axis and between levels), so that
// a texel with this mask is detected above `mixed_above`, which no other mask reaches. With finer
// weights, as on lavapipe, a read may stay below this limit; its light is then too dark, by at most
// 0.1 % where the surface covers all texels of the read.
const float apart_scale = 0.001953125; // 2^-9: halves hold masks down to 1/32 in full precision
const float mixed_mask = 65504.0;      // the largest fp16
const float mixed_above = 1.001 * apart_scale;
// Returns whether one of the 4 or 16 finer texels of a texel has `mixed_mask`. The smallest weight
// is 1/64.
bool spreads_mixed(float mask) { return mask > 2.0; }
// Rounds light times mask (rgb) and mask (a) for storage. A mask below the normal halves loses
// digits. Light then follows the rounding of the mask, because reads divide light by mask.
vec4 round_masked_light(vec4 mean) {
  const float smallest_normal_half = 6.103515625e-5; // 2^-14
  float mask = round_to_half(mean.a);
  if (mean.a > 0.0 && mean.a < smallest_normal_half)
    mean.rgb *= mask / mean.a;
  return vec4(round_to_half(mean.rgb), mask);
}

// Returns a filtered read of a level at texel coordinates. Integers are the centres of texels, 0 is
// the first texel after the border.
vec4 pyramid_read(texture2D level, vec2 at, int border) {
  vec2 size = vec2(textureSize(level, 0));
  return textureLod(sampler2D(level, linear_sampler), (at + float(border) + 0.5) / size, 0.0);
}
vec4 pyramid_read(texture2D level, vec2 at) { return pyramid_read(level, at, pyramid_border); }

#endif
