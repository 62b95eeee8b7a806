#version 460
// Evaluates round_to_half for floats whose exponent is in any range and whose value is a half
// float, or is at, just below or just above the middle between two half floats. Sign, exponent and
// ten bits come from the position, the tail from the channel.
#extension GL_GOOGLE_include_directive : require
#include "common/environment.glsl"
#include "common/half.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 0, rgba32f) uniform writeonly image2D target;
layout(push_constant) uniform push_block { uint port_mask; };

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, frame.rect.zw)))
    return;
  uint head = uint(pixel.y * frame.rect.z + pixel.x) << 13;
  imageStore(
      target, pixel,
      round_to_half(uintBitsToFloat(uvec4(head, head | 0xfffu, head | 0x1000u, head | 0x1001u))));
}
