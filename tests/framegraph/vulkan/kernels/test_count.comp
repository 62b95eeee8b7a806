#version 460
// Doubles the counter and adds one, so that the order of passes shows in it. Writes the counter to
// the first texel.
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
layout(local_size_x = 1) in;
layout(set = 0, binding = 0, r32f) uniform writeonly image2D target;
layout(set = 1, binding = 3) buffer counter_block { uint counter; };
layout(push_constant) uniform push_block { uint port_mask; };

void main() {
  counter = 2u * counter + 1u;
  imageStore(target, ivec2(0), vec4(float(counter)));
}
