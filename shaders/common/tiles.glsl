// Iteration over listed 8x8 tiles. Include after the bindings of a kernel with a `tiles` port.
#ifndef DERMIS_TILES_GLSL
#define DERMIS_TILES_GLSL

#include "common/tile_packing.glsl"

layout(local_size_x = 8, local_size_y = 8, local_size_z = 1) in;

// Computes the pixel of this invocation, relative to the rectangle's corner. Returns false beyond
// the end of the list or of the rectangle. `copy_only` and `full` (all pixels of the tile have
// subsurface) are uniform over the group.
bool listed_pixel(out ivec2 pixel, out bool copy_only, out bool full) {
  uint index = gl_WorkGroupID.y * tile_groups_per_row + gl_WorkGroupID.x;
  pixel = ivec2(0);
  copy_only = false;
  full = false;
  if (index >= tiles_data[0])
    return false;
  uint tile = tiles_data[1u + index];
  copy_only = (tile & tile_copy_bit) != 0u;
  full = (tile & tile_full_bit) != 0u;
  pixel = ivec2(tile & 0x7fffu, (tile >> 15) & 0x7fffu) * 8 + ivec2(gl_LocalInvocationID.xy);
  return full || inside_rect(pixel);
}
bool listed_pixel(out ivec2 pixel, out bool copy_only) {
  bool full;
  return listed_pixel(pixel, copy_only, full);
}

#endif
