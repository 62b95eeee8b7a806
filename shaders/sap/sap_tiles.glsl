// The listed 8x8 tiles of a level of the surface-aware pyramid.
#ifndef DERMIS_SAP_TILES_GLSL
#define DERMIS_SAP_TILES_GLSL

#include "sap/sap_lists.glsl"

// Returns an element of the buffer `level_tiles` (sap_lists.glsl). The kernel defines the function
// if it includes sap_blocks.glsl or sap_window.glsl.
uvec2 level_tiles_at(uint index);

// Texels of a tile that an invocation computes.
struct texel_block {
  ivec2 first;   // address of the first texel, counted from the corner of the level's border
  ivec2 tile;
  bool copy_only; // level 0: no pixel of the tile scatters further than itself
  // Mask of written tiles among the 3x3 tiles of the finer level that the own tile reduces.
  uint children;
  uint around;   // mask of written tiles among the 3x3 tiles around
};

ivec2 tile_of_entry(uvec2 entry) { return ivec2(entry.x & 0x7fffu, (entry.x >> 15) & 0x7fffu); }

// Returns the block of a listed tile that starts at `offset` in the tile.
texel_block block_of_entry(uvec2 entry, ivec2 offset) {
  texel_block block;
  block.tile = tile_of_entry(entry);
  block.first = 8 * block.tile + offset;
  block.copy_only = (entry.x & tile_copy_bit) != 0u;
  block.children = entry.y & 0x1ffu;
  block.around = entry.y >> 9;
  return block;
}
// Returns texel i of a listed tile, row by row, as a block.
texel_block texel_of_entry(uvec2 entry, int i) {
  return block_of_entry(entry, ivec2(i & 7, i >> 3));
}

uint dispatched_group() { return gl_WorkGroupID.y * tile_groups_per_row + gl_WorkGroupID.x; }

// Returns whether a tile was written, by its offset of 0 to 2 from the first of the mask's 3x3
// tiles.
bool tile_written(uint mask, ivec2 offset) {
  return (mask >> uint(3 * offset.y + offset.x) & 1u) != 0u;
}

#endif
