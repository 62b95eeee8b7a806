#version 460
// Classifies one tile of the rectangle per invocation, 64 per group: class = 1 for every third
// tile.
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
layout(local_size_x = 64) in;
layout(set = 0, binding = 0) writeonly buffer classes_block { uint classes[]; };
layout(push_constant) uniform push_block { uint port_mask; };

void main() {
  uint tiles = uint((frame.rect.z + 7) / 8 * ((frame.rect.w + 7) / 8));
  uint tile = gl_GlobalInvocationID.x;
  if (tile < tiles) classes[tile] = tile % 3u == 0u ? 1u : 0u;
}
