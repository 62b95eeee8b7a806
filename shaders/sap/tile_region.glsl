// Flags of tiles of levels 0 to 3 in a region and around it: whether a tile can hold surface. A
// region has one tile of level 4, and twice as many tiles per side in each finer level. A tile
// reduces 3x3 tiles of the finer level, from twice its position minus one. Level 3 has flags for
// one tile around the region, so level 0 has flags for 39x39 tiles.
#ifndef DERMIS_TILE_REGION_GLSL
#define DERMIS_TILE_REGION_GLSL

#include "common/environment.glsl"
#include "common/even_bits.glsl"
#include "common/tile_packing.glsl"
#include "sap/sap_lists.glsl"

// Returns an element of the buffer `classes`. The kernel that includes this file defines the
// function.
uint class_at(int tile);

const int region_levels = 4;
const int region_tiles = 16 * 16 + 8 * 8 + 4 * 4 + 2 * 2;
// A word per row of flags of all levels, and the flags from the 32nd on of the rows of level 0.
shared uint flags[39 + 19 + 9 + 4], flags_beyond[39];

// Returns the first level from `level` on whose step to the next one halves each axis.
ivec2 halved_from(int level) {
  return square_pixels ? ivec2(level) : max(ivec2(level), ivec2(kept_x, kept_y));
}
// Returns the tiles per side of the region, and those per side that have flags: 39, 19, 9, 4; less
// along an axis that is not halved.
ivec2 region_side(int level) { return ivec2(16) >> halved_from(level); }
ivec2 flagged_side(int level) {
  ivec2 halved = halved_from(level);
  return (ivec2(40) >> halved) - 1 + 2 * (halved - level);
}
// Returns the number of flagged tiles before the region along each axis.
ivec2 flagged_before(int level) {
  ivec2 halved = halved_from(level);
  return (ivec2(16) >> halved) - 1 + (halved - level);
}
// Returns the index of the level's first row of flags.
int flags_row(int level) { return 80 - (80 >> level) - level; }
ivec2 first_flagged(int level, ivec2 region) {
  return region * region_side(level) - flagged_before(level);
}

// Returns a bit for each of the 3x3 tiles from `place` on, counted from the first flagged tile.
uint flags_from(int level, ivec2 place) {
  int row = flags_row(level) + place.y;
  return (flags[row] >> uint(place.x) & 7u) | (flags[row + 1] >> uint(place.x) & 7u) << 3 |
         (flags[row + 2] >> uint(place.x) & 7u) << 6;
}

void clear_flags(int lane, int lanes) {
  for (int i = lane; i < flags.length(); i += lanes)
    flags[i] = 0u;
  for (int i = lane; i < flags_beyond.length(); i += lanes)
    flags_beyond[i] = 0u;
}

const int run_tiles = 13, runs_per_row = 3, class_runs = 39 * runs_per_row;

// Sets the flags of a run of tiles of level 0. Returns whether any of them scatters.
bool read_classes(ivec2 region, int run) {
  ivec2 place = ivec2(run % runs_per_row * run_tiles, run / runs_per_row);
  ivec2 first = first_flagged(0, region) + place;
  uint bits = 0u;
  bool scatters = false;
  [[unroll]] for (int i = 0; i < run_tiles; ++i) {
    ivec2 tile = first + ivec2(i, 0), near = clamp(tile, ivec2(0), frame.tiles - 1);
    uint entry = class_at(near.y * frame.tiles.x + near.x);
    uint found = tile == near ? class_of_tile(entry) : class_none;
    bits |= found != class_none ? 1u << uint(i) : 0u;
    scatters = scatters || found == class_scatter;
  }
  if (bits != 0u)
    atomicOr(flags[place.y], bits << uint(place.x));
  uint beyond = place.x + run_tiles > 32 ? bits >> uint(32 - place.x) : 0u;
  if (beyond != 0u)
    flags_beyond[place.y] = beyond;
  return scatters;
}

// Computes a row of flags of levels 1 to 3 from those of the finer level.
void reduce_flags(ivec2 region, int level, int row) {
  ivec2 step = step_from_level(level - 1);
  int finer = flags_row(level - 1) + step.y * row;
  uint bits = flags[finer] | flags[finer + 1] | flags[finer + 2], beyond = 0u;
  if (level == 1 && step.x > 1)
    beyond = flags_beyond[step.y * row] | flags_beyond[step.y * row + 1] |
             flags_beyond[step.y * row + 2];
  bits |= bits >> 1 | bits >> 2 | beyond << 31 | beyond << 30;
  beyond |= beyond >> 1 | beyond >> 2;
  ivec2 first = first_flagged(level, region), tiles = sap_level_tiles(level);
  ivec2 range = clamp(ivec2(0, tiles.x) - first.x, ivec2(0), ivec2(32));
  uint inside = bits_below(range.y) & ~bits_below(range.x);
  bool exists = first.y + row >= 0 && first.y + row < tiles.y;
  flags[flags_row(level) + row] =
      exists ? (step.x > 1 ? even_bits(bits) | even_bits(beyond) << 16 : bits) & inside : 0u;
}

struct region_tile {
  int level;
  ivec2 place; // in the region
};
// Returns tile `index` of all levels of the region.
region_tile region_tile_of(int index) {
  int level = index < 256 ? 0 : index < 320 ? 1 : index < 336 ? 2 : 3;
  int first = index < 256 ? 0 : index < 320 ? 256 : index < 336 ? 320 : 336;
  int side = 16 >> level, i = index - first;
  return region_tile(level, ivec2(i & (side - 1), i >> (4 - level)));
}
bool is_flagged(region_tile tile) {
  ivec2 place = tile.place + flagged_before(tile.level);
  if (!square_pixels && any(greaterThanEqual(tile.place, region_side(tile.level))))
    return false;
  return (flags[flags_row(tile.level) + place.y] >> uint(place.x) & 1u) != 0u;
}
// Returns the flags of the 3x3 tiles of the finer level that the tile reduces, and of those around
// it.
uint region_children(region_tile tile) {
  return tile.level > 0
             ? flags_from(tile.level - 1, step_from_level(tile.level - 1) *
                                              (tile.place + flagged_before(tile.level)))
             : 0u;
}
uint region_around(region_tile tile) {
  return flags_from(tile.level, tile.place + flagged_before(tile.level) - 1);
}

#endif
