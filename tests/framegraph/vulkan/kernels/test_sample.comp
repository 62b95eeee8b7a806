#version 460
// Samples `a` a quarter of a texel to the right and multiplies it by the table's second entry.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "frame.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 0) uniform texture2D a;
layout(set = 0, binding = 1, r32f) uniform writeonly image2D target;
layout(push_constant) uniform push_block { uint port_mask; };

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, frame.rect.zw))) return;
  vec2 at = (vec2(pixel) + vec2(0.75, 0.5)) / vec2(textureSize(a, 0));
  imageStore(target, pixel, textureLod(sampler2D(a, linear_sampler), at, 0.0) * table[1]);
}
