// The lists of tiles of all levels of the surface-aware pyramid in one buffer of uvec2: for each level the index of its
// first entry and their number; then the entries. x: tile x in bits 0-14, y in bits 15-29, of level 0 bit 30 = all pixels
// have subsurface, bit 31 = copy only; y: which of 3x3 tiles were written, row by row, in bits 0-8 those of the finer level
// that the tile reduces (from twice its place minus one), in bits 9-17 those around it.
#ifndef DERMIS_SAP_LISTS_GLSL
#define DERMIS_SAP_LISTS_GLSL

#include "sap/sap.glsl"
#include "common/tile_packing.glsl"

// 8x8 tiles of a level, its border included.
ivec2 sap_level_tiles(int level) { return (sap_level_size(level) + (level > 0 ? 2 : 0) + 7) >> 3; }

#endif
