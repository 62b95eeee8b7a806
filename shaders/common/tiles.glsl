// Iteration over listed 8x8 tiles, one group per tile. A list is a buffer of uints: the number of
// tiles, then the tiles as pack_tile packs them.
#ifndef DERMIS_TILES_GLSL
#define DERMIS_TILES_GLSL

#include "common/environment.glsl"
#include "common/tile_packing.glsl"

layout(local_size_x = 8, local_size_y = 8, local_size_z = 1) in;

// Returns the index of this group's tile among the listed tiles. The last row of groups reaches
// beyond the end of the list.
uint listed_tile() { return gl_WorkGroupID.y * tile_groups_per_row + gl_WorkGroupID.x; }

// Computes the pixel of this invocation in a listed tile, relative to the rectangle's corner.
// Returns false beyond the end of the rectangle. `copy_only` and `full` (all pixels of the tile
// have subsurface) are uniform over the group.
bool pixel_of_tile(uint tile, out ivec2 pixel, out bool copy_only, out bool full) {
  copy_only = (tile & tile_copy_bit) != 0u;
  full = (tile & tile_full_bit) != 0u;
  pixel = ivec2(tile & 0x7fffu, (tile >> 15) & 0x7fffu) * 8 + ivec2(gl_LocalInvocationID.xy);
  return full || inside_rect(pixel);
}
bool pixel_of_tile(uint tile, out ivec2 pixel, out bool copy_only) {
  bool full;
  return pixel_of_tile(tile, pixel, copy_only, full);
}

#endif
