#version 460
// Writes tile classes of the test, which are the values of the table of questions, as
// subsurface.classify does.
#extension GL_GOOGLE_include_directive : require
#include "common/environment.glsl"
#include "common/list_state.glsl"
layout(local_size_x = 64) in;
layout(std430, set = 0, binding = 0) writeonly buffer classes_block { uint classes[]; };
layout(std430, set = 0, binding = 1) writeonly buffer state_block { uint list_state[]; };
layout(push_constant) uniform push_block { uint port_mask; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i < uint(state_words))
    list_state[i] = 0u;
  if (i < uint(frame.tiles.x * frame.tiles.y))
    classes[i] = uint(separable_rows[i / 4u][i % 4u]);
}
