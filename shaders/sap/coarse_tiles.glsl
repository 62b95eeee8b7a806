// Flags of the tiles of levels 4 to 8 of the whole view: whether a tile can hold surface. One tile
// in front of each row and column of flags and two behind are never set, so that all 3x3 tiles of a
// finer level that a tile reduces have flags.
#ifndef DERMIS_COARSE_TILES_GLSL
#define DERMIS_COARSE_TILES_GLSL

#include "common/even_bits.glsl"
#include "sap/sap_lists.glsl"

const int coarse_level = 4;
const int coarse_levels = sap_levels - coarse_level;
const int coarse_words = sap_coarse_words << pixel_doublings;
shared uint coarse_flags[coarse_words];

// Flags of a level: its tiles, words of a row, and the index of its first word. Computed once,
// because several levels add up.
struct coarse_place {
  ivec2 tiles;
  int across;
  int first;
};
shared coarse_place coarse_places[coarse_levels];

int coarse_across(ivec2 tiles) { return (tiles.x + 3 + 31) >> 5; }

// Computes the place of a level, by one invocation.
void place_coarse_level(int level) {
  ivec2 tiles = sap_level_tiles(level);
  int first = 0;
  [[dont_unroll]] for (int finer = coarse_level; finer < level; ++finer) {
    ivec2 others = sap_level_tiles(finer);
    first += coarse_across(others) * (others.y + 3);
  }
  coarse_places[level - coarse_level] = coarse_place(tiles, coarse_across(tiles), first);
}
coarse_place place_of_coarse(int level) { return coarse_places[level - coarse_level]; }

// Sets the flag of a tile of level 4.
void set_coarse_flag(ivec2 tile) {
  ivec2 place = tile + 1;
  atomicOr(coarse_flags[place.y * place_of_coarse(coarse_level).across + (place.x >> 5)],
           1u << uint(place.x & 31));
}

bool is_coarse_flagged(int level, ivec2 tile) {
  ivec2 place = tile + 1;
  coarse_place own = place_of_coarse(level);
  uint word = coarse_flags[own.first + place.y * own.across + (place.x >> 5)];
  return (word >> uint(place.x & 31) & 1u) != 0u;
}

// Returns a bit for each of the 3x3 tiles from `tile` on.
uint coarse_flags_from(int level, ivec2 tile) {
  ivec2 place = tile + 1;
  coarse_place own = place_of_coarse(level);
  int across = own.across, shift = place.x & 31;
  int word = own.first + place.y * across + (place.x >> 5);
  uint found = 0u;
  for (int row = 0; row < 3; ++row, word += across) {
    uint bits = coarse_flags[word] >> uint(shift);
    if (shift > 29)
      bits |= coarse_flags[word + 1] << uint(32 - shift);
    found |= (bits & 7u) << uint(3 * row);
  }
  return found;
}

// Returns a word of three rows of flags from `row` on; 0 outside the rows.
uint coarse_rows(int first, int across, int row, int word) {
  int at = first + row * across + word;
  return word >= 0 && word < across
             ? coarse_flags[at] | coarse_flags[at + across] | coarse_flags[at + 2 * across]
             : 0u;
}

// Computes word `index` of the rows of tiles of a level above 4 from the finer level.
void reduce_coarse_flags(int level, int index) {
  coarse_place own = place_of_coarse(level), below = place_of_coarse(level - 1);
  int finer = below.first, finer_across = below.across;
  int row = index / own.across, word = index % own.across;
  uint before = coarse_rows(finer, finer_across, 2 * row, 2 * word - 1);
  uint low = coarse_rows(finer, finer_across, 2 * row, 2 * word);
  uint high = coarse_rows(finer, finer_across, 2 * row, 2 * word + 1);
  // Bit 2 i: flags 2 i - 2 to 2 i, because flags have one tile in front.
  high |= high << 1 | high << 2 | low >> 31 | low >> 30;
  low |= low << 1 | low << 2 | before >> 31 | before >> 30;
  ivec2 range = clamp(ivec2(1, own.tiles.x + 1) - 32 * word, ivec2(0), ivec2(32));
  uint inside = bits_below(range.y) & ~bits_below(range.x);
  coarse_flags[own.first + (row + 1) * own.across + word] =
      (even_bits(low) | even_bits(high) << 16) & inside;
}

#endif
