#version 460
// Computes out = value + slope * x + frame.time inside the rectangle.
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 0, r32f) uniform writeonly image2D target;
layout(push_constant) uniform push_block { uint port_mask; float value; int slope; };

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, frame.rect.zw))) return;
  imageStore(target, frame.rect.xy + pixel,
             vec4(value + float(slope * pixel.x) + frame.time, 0, 0, 0));
}
