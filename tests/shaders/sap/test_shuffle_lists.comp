#version 460
// Permutes the entries of lists of tiles: reverses each list and swaps its halves. Then no entry of
// a list with more than three entries keeps its place.
#extension GL_GOOGLE_include_directive : require
#include "constants.glsl"
layout(local_size_x = 64) in;
layout(std430, set = 0, binding = 0) buffer b0 { uint tiles[]; };
layout(std430, set = 0, binding = 1) buffer b1 { uvec2 level_tiles[]; };
layout(push_constant) uniform push_block { uint port_mask; };

void swap_tiles(uint a, uint b) {
  uint kept = tiles[a];
  tiles[a] = tiles[b];
  tiles[b] = kept;
}
void swap_entries(uint a, uint b) {
  uvec2 kept = level_tiles[a];
  level_tiles[a] = level_tiles[b];
  level_tiles[b] = kept;
}

void main() {
  uint lane = gl_LocalInvocationIndex, count = tiles[0];
  for (uint i = lane; i < count / 2u; i += 64u)
    swap_tiles(1u + i, count - i);
  memoryBarrierBuffer();
  barrier();
  for (uint i = lane; i < count / 2u; i += 64u)
    swap_tiles(1u + i, 1u + i + count / 2u);
  if ((port_mask & 2u) == 0u)
    return;
  for (int level = 0; level < sap_levels; ++level) {
    uvec2 list = level_tiles[level];
    for (uint i = lane; i < list.y / 2u; i += 64u)
      swap_entries(list.x + i, list.x + list.y - 1u - i);
    memoryBarrierBuffer();
    barrier();
    for (uint i = lane; i < list.y / 2u; i += 64u)
      swap_entries(list.x + i, list.x + i + list.y / 2u);
  }
}
