#version 460
// Evaluates view_normal of a normal that differs in each pixel.
#extension GL_GOOGLE_include_directive : require
#include "common/environment.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 0, rgba32f) uniform writeonly image2D target;
layout(push_constant) uniform push_block { uint port_mask; };

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, frame.rect.zw)))
    return;
  imageStore(target, pixel, vec4(view_normal(vec3(pixel, pixel.x - pixel.y + 0.5)), 0.0));
}
