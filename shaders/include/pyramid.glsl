// The plain pyramid's images: level l has a texel every 2^l pixels of the rectangle and a border of two texels.
#ifndef DERMIS_PYRAMID_GLSL
#define DERMIS_PYRAMID_GLSL

#include "environment.glsl"

layout(set = 1, binding = 3) uniform sampler linear_sampler;

const int pyramid_border = 2;

// Filtered read of a level at texel coordinates, integers at the centres of its texels.
vec4 pyramid_read(texture2D level, vec2 at) {
  vec2 size = vec2(textureSize(level, 0));
  return textureLod(sampler2D(level, linear_sampler), (at + float(pyramid_border) + 0.5) / size, 0.0);
}

#endif
