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
shared uint scatters;             // whether any tile scatters; if not, only level 0 is needed

shared bool is_last;

int lane() { return int(gl_LocalInvocationIndex); }

// Returns, to all invocations, whether this group is the last to call the function. Then all other
// groups' atomic operations on `list_state` are visible.
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
  level_tiles_data[sap_first_entry(level) + at] = uvec2(place, children | around << 9);
}
uint place_of(ivec2 tile) { return uint(tile.x) | uint(tile.y) << 15; }

const uint unlisted = 0xffffffffu;
void append_region(ivec2 region) {
  const int steps = (region_tiles + lanes - 1) / lanes;
  uint at[steps];
  [[unroll]] for (int k = 0; k < steps; ++k) {
    int index = lane() + k * lanes;
    region_tile own = region_tile_of(index);
    at[k] = index < region_tiles && is_flagged(own) ? atomicAdd(listed[own.level], 1u) : unlisted;
  }
  barrier();
  if (lane() < region_levels && listed[lane()] > 0u)
    first[lane()] = atomicAdd(list_state_data[lane()], listed[lane()]);
  barrier();
  [[unroll]] for (int k = 0; k < steps; ++k) {
    region_tile own = region_tile_of(lane() + k * lanes);
    if (at[k] == unlisted)
      continue;
    ivec2 tile = region * region_side(own.level) + own.place;
    uint place = place_of(tile);
    at[k] += first[own.level];
    if (own.level == 0) {
      place = pack_tile(uvec2(tile), classes_data[tile.y * frame.tiles.x + tile.x]);
      tiles_data[1u + at[k]] = place;
    }
    write_entry(own.level, at[k], place, region_children(own), region_around(own));
  }
}

void list_coarse_levels() {
  for (int i = lane(); i < coarse_words; i += lanes)
    coarse_flags[i] = 0u;
  uint word = lane() < state_words ? state_word(lane()) : 0u;
  if (lane() < sap_levels)
    listed[lane()] = lane() < region_levels ? word : 0u;
  if (lane() == state_scatters)
    scatters = word;
  barrier();
  ivec2 tiles = sap_level_tiles(coarse_level);
  for (int i = lane(); i < tiles.x * tiles.y; i += lanes)
    if (state_word(state_words + i) != 0u)
      set_coarse_flag(ivec2(i % tiles.x, i / tiles.x));
  barrier();
  for (int level = coarse_level + 1; level < sap_levels; ++level) {
    int words = coarse_across(level) * sap_level_tiles(level).y;
    for (int i = lane(); i < words; i += lanes)
      reduce_coarse_flags(level, i);
    barrier();
  }
  for (int level = coarse_level; level < sap_levels; ++level) {
    tiles = sap_level_tiles(level);
    for (int i = lane(); i < tiles.x * tiles.y; i += lanes) {
      ivec2 tile = ivec2(i % tiles.x, i / tiles.x);
      if (!is_coarse_flagged(level, tile))
        continue;
      uint children = level == coarse_level ? state_word(state_words + i)
                                            : coarse_flags_from(level - 1, 2 * tile - 1);
      write_entry(level, atomicAdd(listed[level], 1u), place_of(tile), children,
                  coarse_flags_from(level, tile - 1));
    }
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
  level_tiles_data[level] = uvec2(sap_first_entry(level), count);
  level_arguments_data[4 * level] = min(groups, tile_groups_per_row);
  level_arguments_data[4 * level + 1] = (groups + tile_groups_per_row - 1u) / tile_groups_per_row;
  level_arguments_data[4 * level + 2] = 1u;
  level_arguments_data[4 * level + 3] = groups;
  counters.level_groups[level] = groups;
}

void list_region(ivec2 region, int word) {
  if (lane() < region_levels)
    listed[lane()] = 0u;
  clear_flags(lane(), lanes);
  barrier();
  for (int run = lane(); run < class_runs; run += lanes)
    if (read_classes(region, run))
      atomicOr(scatters, 1u);
  barrier();
  for (int level = 1; level < region_levels; ++level) {
    if (lane() < flagged_side(level).y)
      reduce_flags(region, level, lane());
    barrier();
  }
  uint children = flags_from(region_levels - 1, ivec2(0)); // of the region's tile of level 4
  if (children != 0u)
    append_region(region);
  if (lane() == 0) {
    atomicExchange(list_state_data[state_words + word], children);
    if (scatters != 0u)
      atomicOr(list_state_data[state_scatters], 1u);
  }
}

void main() {
  if (lane() == 0)
    scatters = 0u;
  if (square_pixels) {
    list_region(ivec2(gl_WorkGroupID.xy),
                int(gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x));
  } else {
    // Levels that do not halve an axis have several regions per group along it.
    ivec2 tiles = sap_level_tiles(coarse_level);
    for (int k = 0; k < 1 << pixel_doublings; ++k) {
      ivec2 region = ivec2(gl_WorkGroupID.xy) * ivec2(1 << kept_x, 1 << kept_y) +
                     (higher_pixels ? ivec2(0, k) : ivec2(k, 0));
      if (all(lessThan(region, tiles)))
        list_region(region, region.y * tiles.x + region.x);
      barrier();
    }
  }
  if (!last_group())
    return;
  list_coarse_levels();
  if (lane() == 0)
    write_arguments();
  if (lane() < sap_levels)
    write_level_arguments(lane());
  if (lane() < state_words)
    list_state_data[lane()] = 0u;
}
