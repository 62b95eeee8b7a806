// Packs a tile into a list entry, and folds lists that are longer than a dispatch dimension into
// rows of groups.
#ifndef DERMIS_TILE_PACKING_GLSL
#define DERMIS_TILE_PACKING_GLSL

const uint class_none = 0u;    // no subsurface
const uint class_scatter = 1u;
const uint class_copy = 2u;    // no pixel scatters further than itself: copied
// Would scatter, but light is uniform as far as it reaches: copied.
const uint class_uniform = 3u;
// Flag in addition to the class: all 64 pixels have subsurface.
const uint class_full_bit = 4u;

uint class_of_tile(uint entry) { return entry & 3u; }

const uint tile_copy_bit = 0x80000000u;
const uint tile_full_bit = 0x40000000u;

// Returns the list entry of a tile with `classes` entry `entry`.
uint pack_tile(uvec2 tile, uint entry) {
  return tile.x | tile.y << 15 | (class_of_tile(entry) != class_scatter ? tile_copy_bit : 0u) |
         ((entry & class_full_bit) != 0u ? tile_full_bit : 0u);
}
// Below the 65535 groups per dimension that Vulkan guarantees.
const uint tile_groups_per_row = 32768u;

#endif
