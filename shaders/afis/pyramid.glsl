// The plain pyramid's images: level l has a texel every 2^l pixels of the rectangle and a border of two texels.
#ifndef DERMIS_PYRAMID_GLSL
#define DERMIS_PYRAMID_GLSL

#include "common/environment.glsl"

layout(set = 1, binding = 3) uniform sampler linear_sampler;

const int pyramid_border = 2;

// Chains that keep profiles apart: masks are stored as `apart_scale` of themselves and a pixel beside another profile has
// `mixed_mask`, which spreads to every texel that it has a part in. Filtered reads have weights of 2^-16 or more (8 bits
// an axis), so that a texel with it is seen from `mixed_above` on, which no mask reaches.
const float apart_scale = 0.0625;
const float mixed_mask = 65504.0; // the largest fp16
const float mixed_above = 0.07;
// Whether a level's texel, made of sixteen or four others, has one with `mixed_mask` among them: the least weight is 1/64.
bool spreads_mixed(float mask) { return mask > 2.0; }

// Filtered read of a level at texel coordinates, integers at the centres of its texels.
vec4 pyramid_read(texture2D level, vec2 at) {
  vec2 size = vec2(textureSize(level, 0));
  return textureLod(sampler2D(level, linear_sampler), (at + float(pyramid_border) + 0.5) / size, 0.0);
}

#endif
