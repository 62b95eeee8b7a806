#version 460
// Lists, for every level of the surface-aware pyramid, the 8x8 tiles that can hold surface, and
// writes the arguments of indirect dispatches over them. A group appends the tiles of levels 0 to 3
// of a region to the lists. The group that ends last lists levels 4 to 8.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "sap/subsurface_sap_tiles.bindings.glsl"
#include "common/environment.glsl"
#include "constants.glsl"
#include "common/counters.glsl"
#include "common/list_state.glsl"
#include "common/shape.glsl"
#include "sap/coarse_tiles.glsl"
#include "sap/sap_lists.glsl"
#include "sap/tile_region.glsl"

const int lanes = 128;
layout(local_size_x = 128, local_size_y = 1, local_size_z = 1) in;

shared uint listed[sap_levels]; // tiles of each level
shared uint first[region_levels]; // index of the group's first tile in the list of each level
shared uint first_entries[sap_levels]; // of the levels
shared uint scatters; // whether any tile scatters; if not, only level 0 is needed
shared bool is_last;

uint class_at(int tile) { return classes_data[tile]; }

int lane() { return int(gl_LocalInvocationIndex); }

// Returns, to all invocations, whether this group is the last to call the function. Then all other
// groups' atomic operations on `list_state` are visible, but not their entries.
bool last_group() {
  memoryBarrierBuffer();
  barrier();
  if (gl_LocalInvocationIndex == 0u)
    is_last = atomicAdd(list_state_data[state_ended], 1u) + 1u == list_groups();
  barrier();
  memoryBarrierBuffer();
  return is_last;
}

// Returns a word that other groups wrote.
uint state_word(int word) { return atomicOr(list_state_data[word], 0u); }

void write_entry(int level, uint at, uint place, uint children, uint around) {
  level_tiles_data[first_entries[level] + at] = uvec2(place, children | around << 9);
}
uint place_of(ivec2 tile) { return uint(tile.x) | uint(tile.y) << 15; }

const uint unlisted = 0xffffffffu;
const int region_steps = (region_tiles + lanes - 1) / lanes; // tiles of an invocation

// Returns the places of the invocation's tiles in the lists of their levels.
void reserve_entries(bool any, out uint at[region_steps]) {
  [[unroll]] for (int k = 0; k < region_steps; ++k) {
    int index = lane() + k * lanes;
    region_tile own = region_tile_of(index);
    at[k] = any && index < region_tiles && is_flagged(own) ? atomicAdd(listed[own.level], 1u)
                                                           : unlisted;
  }
  barrier();
  if (lane() < region_levels && listed[lane()] > 0u)
    first[lane()] = atomicAdd(list_state_data[lane()], listed[lane()]);
}

void append_region(ivec2 region, uint at[region_steps], uint classes[region_steps]) {
  [[unroll]] for (int k = 0; k < region_steps; ++k) {
    region_tile own = region_tile_of(lane() + k * lanes);
    if (at[k] == unlisted)
      continue;
    ivec2 tile = region * region_side(own.level) + own.place;
    uint place = place_of(tile);
    at[k] += first[own.level];
    if (own.level == 0) {
      place = pack_tile(uvec2(tile), classes[k]);
      tiles_data[1u + at[k]] = place;
    }
    write_entry(own.level, at[k], place, region_children(own), region_around(own));
  }
}

// Reads the words of tiles of level 4 from tile `start` on.
const int coarse_batch = 2; // tiles that an invocation reads at once
void read_children(int start, int tiles, out uint children[coarse_batch]) {
  [[unroll]] for (int k = 0; k < coarse_batch; ++k)
    children[k] = state_word(state_words + min(start + k * lanes, tiles - 1));
}

void list_coarse_tile(int level, ivec2 tile, uint children) {
  write_entry(level, atomicAdd(listed[level], 1u), place_of(tile), children,
              coarse_flags_from(level, tile - 1));
}

void list_coarse_levels() {
  ivec2 side = place_of_coarse(coarse_level).tiles;
  int tiles = side.x * side.y;
  uint word = lane() < state_words ? state_word(lane()) : 0u, children[coarse_batch];
  read_children(lane(), tiles, children);
  for (int i = lane(); i < coarse_words; i += lanes)
    coarse_flags[i] = 0u;
  if (lane() < sap_levels)
    listed[lane()] = lane() < region_levels ? word : 0u;
  if (lane() == state_scatters)
    scatters = word;
  barrier();
  [[dont_unroll]] for (int start = lane(); start < tiles; start += coarse_batch * lanes) {
    if (start >= coarse_batch * lanes)
      read_children(start, tiles, children);
    [[unroll]] for (int k = 0; k < coarse_batch; ++k) {
      int i = start + k * lanes;
      if (i < tiles && children[k] != 0u)
        set_coarse_flag(ivec2(i % side.x, i / side.x));
    }
  }
  barrier();
  [[dont_unroll]] for (int level = coarse_level + 1; level < sap_levels; ++level) {
    int words = place_of_coarse(level).across * place_of_coarse(level).tiles.y;
    for (int i = lane(); i < words; i += lanes)
      reduce_coarse_flags(level, i);
    barrier();
  }
  [[dont_unroll]] for (int start = lane(); start < tiles; start += coarse_batch * lanes) {
    if (tiles > coarse_batch * lanes)
      read_children(start, tiles, children);
    [[unroll]] for (int k = 0; k < coarse_batch; ++k) {
      int i = start + k * lanes;
      if (i < tiles && children[k] != 0u)
        list_coarse_tile(coarse_level, ivec2(i % side.x, i / side.x), children[k]);
    }
  }
  // Levels 5 to 8, one after another.
  int level = coarse_level + 1;
  side = place_of_coarse(level).tiles;
  [[dont_unroll]] for (int i = lane(); level < sap_levels;) {
    if (i >= side.x * side.y) {
      i -= side.x * side.y;
      if (++level < sap_levels)
        side = place_of_coarse(level).tiles;
      continue;
    }
    ivec2 tile = ivec2(i % side.x, i / side.x);
    if (is_coarse_flagged(level, tile))
      list_coarse_tile(level, tile, coarse_flags_from(level - 1, 2 * tile - 1));
    i += lanes;
  }
  barrier();
}

// Writes what dispatches over `tiles` need.
void write_arguments() {
  uint count = listed[0], rows = (count + tile_groups_per_row - 1u) / tile_groups_per_row;
  tiles_data[0] = count;
  arguments_data[0] = min(count, tile_groups_per_row);
  arguments_data[1] = rows;
  arguments_data[2] = 1u;
  if (has_copy_arguments()) {
    copy_arguments_data[0] = scatters == 0u ? min(count, tile_groups_per_row) : 0u;
    copy_arguments_data[1] = rows;
    copy_arguments_data[2] = 1u;
  }
}

void write_level_arguments(int level) {
  // If nothing scatters, light is copied by a pass over `copy_arguments`, or by the pyramid's last
  // step, which needs level 0.
  bool needed = scatters != 0u || level == 0 && !has_copy_arguments();
  uint count = needed ? listed[level] : 0u;
  uint per_group = texel_shape  ? 1u
                   : level == 0 ? sap_tiles_per_group_first
                                : sap_tiles_per_group;
  uint groups = (count + per_group - 1u) / per_group;
  level_tiles_data[level] = uvec2(first_entries[level], count);
  level_arguments_data[4 * level] = min(groups, tile_groups_per_row);
  level_arguments_data[4 * level + 1] = (groups + tile_groups_per_row - 1u) / tile_groups_per_row;
  level_arguments_data[4 * level + 2] = 1u;
  level_arguments_data[4 * level + 3] = groups;
  counters.level_groups[level] = groups;
}

// Flags the tiles of a region, and reserves places for them. Returns the places and the classes of
// the invocation's tiles.
void flag_region(ivec2 region, int word, out uint at[region_steps],
                 out uint classes[region_steps]) {
  if (lane() < region_levels)
    listed[lane()] = 0u;
  clear_flags(lane(), lanes);
  barrier();
  if (lane() < class_runs && read_classes(region, lane()))
    atomicOr(scatters, 1u);
  [[unroll]] for (int k = 0; k < region_steps; ++k) {
    region_tile own = region_tile_of(lane() + k * lanes);
    ivec2 tile = min(region * region_side(0) + own.place, frame.tiles - 1);
    classes[k] = own.level == 0 ? classes_data[tile.y * frame.tiles.x + tile.x] : 0u;
  }
  barrier();
  [[dont_unroll]] for (int level = 1; level < region_levels; ++level) {
    if (lane() < flagged_side(level).y)
      reduce_flags(region, level, lane());
    barrier();
  }
  uint children = flags_from(region_levels - 1, ivec2(0)); // of the region's tile of level 4
  reserve_entries(children != 0u, at);
  if (lane() == 0) {
    atomicExchange(list_state_data[state_words + word], children);
    if (scatters != 0u)
      atomicOr(list_state_data[state_scatters], 1u);
  }
}

void main() {
  if (lane() == 0)
    scatters = 0u;
  if (lane() < sap_levels)
    first_entries[lane()] = sap_first_entry(lane());
  if (lane() >= coarse_level && lane() < sap_levels)
    place_coarse_level(lane());
  uint at[region_steps], classes[region_steps];
  bool last;
  if (square_pixels) {
    ivec2 region = ivec2(gl_WorkGroupID.xy);
    flag_region(region, int(gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x), at, classes);
    last = last_group(); // before the entries, for which the last group does not need to wait
    append_region(region, at, classes);
  } else {
    // Levels that do not halve an axis have several regions per group along it.
    barrier();
    ivec2 tiles = place_of_coarse(coarse_level).tiles;
    for (int k = 0; k < 1 << pixel_doublings; ++k) {
      ivec2 region = ivec2(gl_WorkGroupID.xy) * ivec2(1 << kept_x, 1 << kept_y) +
                     (higher_pixels ? ivec2(0, k) : ivec2(k, 0));
      if (all(lessThan(region, tiles))) {
        flag_region(region, region.y * tiles.x + region.x, at, classes);
        barrier();
        append_region(region, at, classes);
      }
      barrier();
    }
    last = last_group();
  }
  if (!last)
    return;
  list_coarse_levels();
  if (lane() == 0)
    write_arguments();
  if (lane() < sap_levels)
    write_level_arguments(lane());
  if (lane() < state_words)
    list_state_data[lane()] = 0u;
}
