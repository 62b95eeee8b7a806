#version 460
// Lists, for every level of the surface-aware pyramid, the 8x8 tiles that can hold surface, and
// writes the arguments of indirect dispatches over them. One group and no atomics on the lists, so
// that equal classes give equal lists. Each invocation owns a run of consecutive words of 32 tiles.
#extension GL_GOOGLE_include_directive : require
#include "sap/subsurface_sap_tiles.bindings.glsl"
#include "common/environment.glsl"
#include "constants.glsl"
#include "common/counters.glsl"
#include "common/shape.glsl"
#include "sap/sap_lists.glsl"

const uint lanes = 256u;
layout(local_size_x = 256, local_size_y = 1, local_size_z = 1) in;

// A level with more tiles (views beyond 3500x3500) is listed as a whole.
const int flag_words = 1536;
shared uint flags[2][flag_words]; // flags of the level and of the finer level, one bit per tile
shared uint counts[lanes];
// Whether any tile scatters; if not, only level 0 is needed.
shared uint scatters;

bool fits(ivec2 tiles) { return tiles.x * tiles.y <= 32 * flag_words; }

// Returns whether a tile of a level can hold surface; false outside the level.
bool is_flagged(int level, ivec2 tile) {
  ivec2 tiles = sap_level_tiles(level);
  if (any(lessThan(tile, ivec2(0))) || any(greaterThanEqual(tile, tiles)))
    return false;
  int index = tile.y * tiles.x + tile.x;
  bool flagged = true;
  if (fits(tiles))
    flagged = (flags[level & 1][index >> 5] >> uint(index & 31) & 1u) != 0u;
  else if (level == 0)
    flagged = class_of_tile(classes_data[index]) != class_none;
  return flagged;
}
// Returns a bit for each of the 3x3 tiles from `first` on.
uint flags_from(int level, ivec2 first) {
  uint mask = 0u;
  for (int i = 0; i < 9; ++i)
    mask |= is_flagged(level, first + ivec2(i % 3, i / 3)) ? 1u << uint(i) : 0u;
  return mask;
}

// Returns a bit for each of the 32 tiles from 32 * word on that can hold surface. The flags of the
// finer level must be complete.
uint find_word(int level, int word, ivec2 tiles) {
  int first = 32 * word, count = min(32, tiles.x * tiles.y - first);
  uint bits = 0u;
  for (int i = 0; i < (level == 0 ? count : 0); ++i)
    bits |= class_of_tile(classes_data[first + i]) != class_none ? 1u << uint(i) : 0u;
  ivec2 tile = ivec2(first % tiles.x, first / tiles.x);
  for (int i = 0; i < (level > 0 && fits(tiles) ? count : 0); ++i) {
    bits |= flags_from(level - 1, 2 * tile - 1) != 0u ? 1u << uint(i) : 0u;
    tile = tile.x + 1 < tiles.x ? tile + ivec2(1, 0) : ivec2(0, tile.y + 1);
  }
  if (level > 0 && !fits(tiles))
    bits = count < 32 ? (1u << uint(count)) - 1u : ~0u;
  return bits;
}

void main() {
  uint lane = gl_LocalInvocationIndex;
  uint next = uint(sap_levels); // the heads of the lists come first
  if (lane == 0u)
    scatters = 0u;
  barrier();
  bool any = false;
  for (uint i = lane; i < uint(frame.tiles.x * frame.tiles.y); i += lanes)
    any = any || class_of_tile(classes_data[i]) == class_scatter;
  if (any)
    atomicOr(scatters, 1u);
  barrier();
  // Otherwise light is copied, and the lists of the levels are empty.
  bool builds = scatters != 0u || !has_copy_arguments();
  for (int level = 0; level < (builds ? sap_levels : 1); ++level) {
    ivec2 tiles = sap_level_tiles(level);
    int words = (tiles.x * tiles.y + 31) >> 5, run = (words + int(lanes) - 1) / int(lanes);
    int first = min(int(lane) * run, words), last = min(first + run, words);
    uint own = 0u;
    for (int word = first; word < last; ++word) {
      uint bits = scatters != 0u || level == 0 ? find_word(level, word, tiles) : 0u;
      if (fits(tiles))
        flags[level & 1][word] = bits;
      own += uint(bitCount(bits));
    }
    counts[lane] = own;
    barrier();
    for (uint stride = 1u; stride < lanes; stride *= 2u) { // inclusive scan, Hillis & Steele 1986
      uint before = lane >= stride ? counts[lane - stride] : 0u;
      barrier();
      counts[lane] += before;
      barrier();
    }
    uint at = next + counts[lane] - own;
    for (int word = first; word < last; ++word) {
      uint bits = own == 0u     ? 0u
                  : fits(tiles) ? flags[level & 1][word]
                                : find_word(level, word, tiles);
      while (bits != 0u) {
        int index = 32 * word + findLSB(bits);
        bits &= bits - 1u;
        ivec2 tile = ivec2(index % tiles.x, index / tiles.x);
        uint place = level == 0 ? pack_tile(uvec2(tile), classes_data[index])
                                : uint(tile.x) | uint(tile.y) << 15;
        if (level == 0)
          tiles_data[1u + at - next] = place;
        if (builds) {
          uint children = level > 0 ? flags_from(level - 1, 2 * tile - 1) : 0u;
          level_tiles_data[at] = uvec2(place, children | flags_from(level, tile - 1) << 9);
        }
        ++at;
      }
    }
    uint listed = counts[lanes - 1u];
    if (lane == 0u && level == 0 && has_copy_arguments()) {
      copy_arguments_data[0] = scatters == 0u ? min(listed, tile_groups_per_row) : 0u;
      copy_arguments_data[1] = (listed + tile_groups_per_row - 1u) / tile_groups_per_row;
      copy_arguments_data[2] = 1u;
    }
    if (lane == 0u && level == 0) { // one group per tile
      tiles_data[0] = listed;
      arguments_data[0] = min(listed, tile_groups_per_row);
      arguments_data[1] = (listed + tile_groups_per_row - 1u) / tile_groups_per_row;
      arguments_data[2] = 1u;
    }
    if (lane == 0u && builds) {
      uint per_group = texel_shape  ? 1u
                       : level == 0 ? sap_tiles_per_group_first
                                    : sap_tiles_per_group;
      uint groups = (listed + per_group - 1u) / per_group;
      level_tiles_data[level] = uvec2(next, listed);
      level_arguments_data[4 * level] = min(groups, tile_groups_per_row);
      level_arguments_data[4 * level + 1] =
          (groups + tile_groups_per_row - 1u) / tile_groups_per_row;
      level_arguments_data[4 * level + 2] = 1u;
      level_arguments_data[4 * level + 3] = groups;
      counters.level_groups[level] = groups;
    }
    next += listed;
    barrier();
  }
  if (!builds && lane < uint(sap_levels)) {
    level_tiles_data[lane] = uvec2(0u);
    for (uint i = 0u; i < 4u; ++i)
      level_arguments_data[4u * lane + i] = i == 2u ? 1u : 0u;
    counters.level_groups[lane] = 0u;
  }
}
