#version 460
// Lists the tiles of class 1 in a single invocation.
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
layout(local_size_x = 1) in;
layout(set = 0, binding = 0) readonly buffer classes_block { uint classes[]; };
layout(set = 0, binding = 1) writeonly buffer tiles_block { uint tiles[]; };
layout(set = 0, binding = 2) writeonly buffer arguments_block { uint arguments[]; };
layout(push_constant) uniform push_block { uint port_mask; };

void main() {
  uint across = uint(frame.rect.z + 7) / 8u, down = uint(frame.rect.w + 7) / 8u, listed = 0u;
  for (uint tile = 0u; tile < across * down; ++tile)
    if (classes[tile] == 1u) tiles[listed++] = (tile % across) | ((tile / across) << 16);
  arguments[0] = listed;
  arguments[1] = 1u;
  arguments[2] = 1u;
}
