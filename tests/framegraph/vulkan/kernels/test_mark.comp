#version 460
// Adds one to every pixel of the listed tiles.
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 0) readonly buffer tiles_block { uint tiles[]; };
layout(set = 0, binding = 2, r32f) uniform image2D target;
layout(push_constant) uniform push_block { uint port_mask; };

void main() {
  uint tile = tiles[gl_WorkGroupID.x];
  ivec2 pixel = ivec2(tile & 0xffffu, tile >> 16) * 8 + ivec2(gl_LocalInvocationID.xy);
  if (any(greaterThanEqual(pixel, frame.rect.zw))) return;
  imageStore(target, frame.rect.xy + pixel, imageLoad(target, frame.rect.xy + pixel) + 1.0);
}
