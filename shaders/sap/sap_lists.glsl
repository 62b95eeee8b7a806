// Tile lists of all levels of the surface-aware pyramid in one buffer of uvec2. For each level, the
// buffer holds the index of its first entry and the number of entries. Entries follow, with space
// for all tiles of each level; their order varies.
// x: tile x in bits 0-14, y in bits 15-29; for level 0, bit 30 = all pixels have subsurface, bit 31
// = copy only.
// y: masks of 3x3 written tiles, row by row. Bits 0-8: the tiles of the finer level that the tile
// reduces (from twice its position minus one). Bits 9-17: the tiles around the tile.
#ifndef DERMIS_SAP_LISTS_GLSL
#define DERMIS_SAP_LISTS_GLSL

#include "sap/sap.glsl"
#include "common/tile_packing.glsl"

// Returns the number of 8x8 tiles of a level, including its border.
ivec2 sap_level_tiles(int level) { return (sap_level_size(level) + (level > 0 ? 2 : 0) + 7) >> 3; }
// Returns the index of the level's first entry.
uint sap_first_entry(int level) {
  int first = sap_levels;
  for (int finer = 0; finer < level; ++finer)
    first += sap_level_tiles(finer).x * sap_level_tiles(finer).y;
  return uint(first);
}

#endif
