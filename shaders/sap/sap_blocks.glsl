// Division of listed tiles among invocations. Kernels have two shapes:
// - Texel shape, for GPUs: one texel per invocation and one tile per group. Texels that the group
//   shares are in shared memory.
// - Block shape, for drivers on the CPU: blocks of texels per invocation. A block reads the texels
//   that its own texels share once, without shared memory, which is slow there.
#ifndef DERMIS_SAP_BLOCKS_GLSL
#define DERMIS_SAP_BLOCKS_GLSL

#include "common/shape.glsl"
#include "sap/sap_tiles.glsl"

// The blocks of a level.
struct block_grid {
  ivec2 size; // texels of a block
  int border; // 1 if the level has a border, so that the first texel of a tile is odd; else 0
};
const block_grid pixel_blocks = block_grid(ivec2(4, 2), 0); // level 0
const block_grid texel_blocks = block_grid(ivec2(2, 2), 1); // levels from 1 on

// Returns the texels that an invocation computes.
int block_texels(block_grid grid) { return texel_shape ? 1 : grid.size.x * grid.size.y; }
// Returns the position of texel k in the block.
ivec2 block_offset(block_grid grid, int k) { return ivec2(k % grid.size.x, k / grid.size.x); }

int blocks_across(block_grid grid) { return 8 / grid.size.x; }
int blocks_per_tile(block_grid grid) {
  return texel_shape ? 64 : blocks_across(grid) * (8 / grid.size.y);
}
// Returns the index in the level's list of the tile of block `i` of the 64 blocks of the group.
uint tile_of_block(block_grid grid, uint i) {
  uint per_tile = uint(blocks_per_tile(grid));
  // In the texel shape the index is uniform, so that the entry is read once for the group.
  return texel_shape ? dispatched_group() : dispatched_group() * (64u / per_tile) + i / per_tile;
}
// Returns block `i` of the group, whose tile is `entry`.
texel_block block_in_tile(block_grid grid, uvec2 entry, uint i) {
  int part = int(i) & (blocks_per_tile(grid) - 1), across = blocks_across(grid);
  ivec2 offset = texel_shape ? ivec2(part & 7, part >> 3)
                             : ivec2(part % across, part / across) * grid.size;
  return block_of_entry(entry, offset);
}

// Finds block `i` of the group. Returns false beyond the end of the list. In the texel shape, i is
// the invocation, and all blocks of a group have the same tile.
bool listed_block(block_grid grid, int level, uint i, out texel_block block) {
  uint index = tile_of_block(grid, i);
  uvec2 list = level_tiles_at(uint(level));
  block = texel_block(ivec2(0), ivec2(0), false, 0u, 0u);
  if (index >= list.y)
    return false;
  block = block_in_tile(grid, level_tiles_at(list.x + index), i);
  return true;
}
// Returns block `i` of the group, for which listed_block() has returned true.
texel_block known_block(block_grid grid, int level, uint i) {
  uint first = level_tiles_at(uint(level)).x;
  return block_in_tile(grid, level_tiles_at(first + tile_of_block(grid, i)), i);
}

#endif
