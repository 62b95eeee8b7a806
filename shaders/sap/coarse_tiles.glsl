// Flags of the tiles of levels 4 to 8 of the whole view: whether a tile can hold surface. One tile
// in front of each row and column of flags and two behind are never set, so that all 3x3 tiles of a
// finer level that a tile reduces have flags.
#ifndef DERMIS_COARSE_TILES_GLSL
#define DERMIS_COARSE_TILES_GLSL

#include "common/even_bits.glsl"
#include "sap/sap_lists.glsl"

const int coarse_level = 4;
const int coarse_words = sap_coarse_words << pixel_doublings;
shared uint coarse_flags[coarse_words];

// Returns the words of a row of flags of a level, and the index of its first word.
int coarse_across(int level) { return (sap_level_tiles(level).x + 3 + 31) >> 5; }
int coarse_first(int level) {
  int first = 0;
  for (int finer = coarse_level; finer < level; ++finer)
    first += coarse_across(finer) * (sap_level_tiles(finer).y + 3);
  return first;
}

// Sets the flag of a tile of level 4.
void set_coarse_flag(ivec2 tile) {
  ivec2 place = tile + 1;
  atomicOr(coarse_flags[place.y * coarse_across(coarse_level) + (place.x >> 5)],
           1u << uint(place.x & 31));
}

bool is_coarse_flagged(int level, ivec2 tile) {
  ivec2 place = tile + 1;
  uint word = coarse_flags[coarse_first(level) + place.y * coarse_across(level) + (place.x >> 5)];
  return (word >> uint(place.x & 31) & 1u) != 0u;
}

// Returns a bit for each of the 3x3 tiles from `tile` on.
uint coarse_flags_from(int level, ivec2 tile) {
  ivec2 place = tile + 1;
  int across = coarse_across(level), shift = place.x & 31;
  int word = coarse_first(level) + place.y * across + (place.x >> 5);
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
  int across = coarse_across(level), finer = coarse_first(level - 1);
  int finer_across = coarse_across(level - 1);
  int row = index / across, word = index % across;
  uint before = coarse_rows(finer, finer_across, 2 * row, 2 * word - 1);
  uint low = coarse_rows(finer, finer_across, 2 * row, 2 * word);
  uint high = coarse_rows(finer, finer_across, 2 * row, 2 * word + 1);
  // Bit 2 i: flags 2 i - 2 to 2 i, because flags have one tile in front.
  high |= high << 1 | high << 2 | low >> 31 | low >> 30;
  low |= low << 1 | low << 2 | before >> 31 | before >> 30;
  ivec2 range = clamp(ivec2(1, sap_level_tiles(level).x + 1) - 32 * word, ivec2(0), ivec2(32));
  uint inside = bits_below(range.y) & ~bits_below(range.x);
  coarse_flags[coarse_first(level) + (row + 1) * across + word] =
      (even_bits(low) | even_bits(high) << 16) & inside;
}

#endif
