#version 460
// Writes classes, tile errors and earlier samples of tiles. A row of the table of questions has
// those of a tile.
#extension GL_GOOGLE_include_directive : require
#include "common/environment.glsl"
#include "common/list_state.glsl"
layout(local_size_x = 64) in;
layout(std430, set = 0, binding = 0) writeonly buffer b0 { uint classes[]; };
layout(std430, set = 0, binding = 1) writeonly buffer b1 { uint list_state[]; };
layout(std430, set = 0, binding = 2) writeonly buffer b2 { uint tile_errors[]; };
layout(std430, set = 0, binding = 3) writeonly buffer b3 { uint before[]; };
layout(push_constant) uniform push_block { uint port_mask; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i < uint(state_words))
    list_state[i] = 0u;
  if (i >= uint(frame.tiles.x * frame.tiles.y))
    return;
  uvec4 tile = uvec4(separable_rows[i]);
  classes[i] = tile.x;
  tile_errors[i] = tile.y;
  before[i] = tile.z;
}
