#version 460
// Writes a pattern of 32 values that differs between neighbours: value / 32 to `target`, the value
// to `ids`.
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 0) uniform writeonly image2D target;
layout(set = 0, binding = 1) uniform writeonly uimage2D ids;
layout(push_constant) uniform push_block { uint port_mask; int seed; };

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, frame.rect.zw))) return;
  uint value = uint(3 * pixel.x + 5 * pixel.y + 7 * seed) % 32u;
  if ((port_mask & 1u) != 0u) imageStore(target, pixel, vec4(float(value) / 32.0));
  if ((port_mask & 2u) != 0u) imageStore(ids, pixel, uvec4(value));
}
