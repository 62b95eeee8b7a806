#version 460
// Selects the tiles that scatter, as many as the frame's budget allows, and lists them; the others
// become tiles that are copied. A group handles a run of tiles in row order. Adds the histograms of
// all runs to find two thresholds: for all tiles, and for those that need not be kept. Integer sums
// only, so that equal changes give equal selections.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "common/subsurface_select_tiles.bindings.glsl"
#include "common/environment.glsl"
#include "constants.glsl"
#include "common/counters.glsl"
#include "common/list_state.glsl"
#include "common/reproject.glsl"
#include "common/tile_selection.glsl"

const uint lanes = 128u;
const uint run = tiles_per_run_group / lanes; // tiles of an invocation
const uint own_bins = 2u * selection_bins / lanes;
const uint batch = 8u; // runs whose tiles an invocation reads at once
// Sums take two steps: an invocation first adds the values of a chunk.
const uint chunk = 16u, bin_chunks = selection_bins / chunk, lane_chunks = lanes / chunk;
layout(local_size_x = 128, local_size_y = 1, local_size_z = 1) in;

// Index 0: all tiles. Index 1: tiles that need not be kept.
shared uint tiles_of_bin[2u * selection_bins];
shared uint earlier_of_bin[2u * selection_bins]; // of earlier groups
shared uint tiles_of_chunk[2u * bin_chunks];
shared uvec2 counts[lanes], counts_of_chunk[lane_chunks];
// Bins above are paid in full, and the first `left` tiles of the bin.
shared ivec2 last_bin;
shared uvec2 left;
shared uint listed; // tiles of the group
shared uint base;   // index of the first of them in the list

// Sums the tiles of all runs by bin, and of each chunk of bins.
void sum_histograms(uint lane) {
  uint all[own_bins], earlier[own_bins], groups = list_groups();
  [[unroll]] for (uint i = 0u; i < own_bins; ++i)
    all[i] = earlier[i] = 0u;
  [[dont_unroll]] for (uint group = 0u; group < groups; group += batch) {
    uint tiles[batch * own_bins];
    [[unroll]] for (uint i = 0u; i < batch * own_bins; ++i)
      tiles[i] = histogram_data[min(group + i / own_bins, groups - 1u) * 2u * selection_bins +
                                i % own_bins * lanes + lane];
    [[unroll]] for (uint i = 0u; i < batch * own_bins; ++i) {
      uint at = group + i / own_bins;
      all[i % own_bins] += at < groups ? tiles[i] : 0u;
      earlier[i % own_bins] += at < gl_WorkGroupID.x ? tiles[i] : 0u;
    }
  }
  [[unroll]] for (uint i = 0u; i < own_bins; ++i) {
    tiles_of_bin[i * lanes + lane] = all[i];
    earlier_of_bin[i * lanes + lane] = earlier[i];
  }
  barrier();
  if (lane < 2u * bin_chunks) {
    uint sum = 0u;
    [[unroll]] for (uint i = 0u; i < chunk; ++i)
      sum += tiles_of_bin[lane * chunk + i];
    tiles_of_chunk[lane] = sum;
  }
  barrier();
}

// Returns the tiles in the chunks of bins from `first` on.
uint sum_chunks(uint which, uint first) {
  uint sum = 0u;
  [[unroll]] for (uint i = 0u; i < bin_chunks; ++i)
    sum += i >= first ? tiles_of_chunk[which * bin_chunks + i] : 0u;
  return sum;
}

// Finds the bin where `units` end, if it is in this chunk.
void find_threshold(uint which, uint own_chunk, uint units) {
  uint above = sum_chunks(which, own_chunk + 1u);
  if (above > units || tiles_of_chunk[which * bin_chunks + own_chunk] <= units - above)
    return;
  uint rest = units - above, bin = (own_chunk + 1u) * chunk - 1u;
  for (; tiles_of_bin[which * selection_bins + bin] <= rest; --bin)
    rest -= tiles_of_bin[which * selection_bins + bin];
  last_bin[which] = int(bin);
  left[which] = rest;
}

// Returns next_steady() of the previous frame.
uint steady_before() {
  if (!has_states_before() || !history_usable())
    return all_steady;
  ivec2 tiles = (frame.previous_rect.zw + 7) >> 3;
  return clamp(states_before_data[tiles.x * tiles.y], min_steady, all_steady);
}

void find_thresholds(uint lane) {
  uint demand = sum_chunks(0u, 0u), kept = demand - sum_chunks(1u, 0u);
  uint units = frame.sample_units, steady = next_steady(steady_before(), units, demand, kept);
  if (lane == 0u && gl_WorkGroupID.x == 0u)
    tile_states_data[frame.tiles.x * frame.tiles.y] = steady;
  if (lane < 2u * bin_chunks) {
    uint which = lane / bin_chunks;
    find_threshold(which, lane % bin_chunks,
                   which == 0u ? steady_units(units, demand, steady) : units - min(kept, units));
  }
  barrier();
}

// Returns the sum of the values of earlier invocations.
uvec2 sum_before(uint lane, uvec2 value) {
  counts[lane] = value;
  barrier();
  if (lane < lane_chunks) {
    uvec2 sum = uvec2(0u);
    [[unroll]] for (uint i = 0u; i < chunk; ++i)
      sum += counts[lane * chunk + i];
    counts_of_chunk[lane] = sum;
  }
  barrier();
  uint own_chunk = lane / chunk;
  uvec2 sum = uvec2(0u);
  [[unroll]] for (uint i = 0u; i < lane_chunks; ++i)
    sum += i < own_chunk ? counts_of_chunk[i] : uvec2(0u);
  [[unroll]] for (uint i = 0u; i < chunk; ++i)
    sum += i < lane % chunk ? counts[own_chunk * chunk + i] : uvec2(0u);
  return sum;
}

// Returns whether a tile of this bin is paid. `earlier` counts the tiles of the last bin so far.
bool is_paid(uint which, uint bin, inout uvec2 earlier) {
  if (int(bin) != last_bin[which])
    return int(bin) > last_bin[which];
  return earlier[which]++ < left[which];
}

// Returns whether this group is the last to call the function, for one invocation of each group.
// The invocation's earlier atomic operations on `list_state` are then visible to the last one.
bool ends_last() {
  memoryBarrierBuffer();
  bool last = atomicAdd(list_state_data[state_ended], 1u) + 1u == list_groups();
  memoryBarrierBuffer();
  return last;
}

void write_arguments() {
  uint all = atomicExchange(list_state_data[0], 0u);
  list_state_data[state_ended] = 0u;
  selected_tiles_data[0] = all;
  selected_arguments_data[0] = min(all, tile_groups_per_row);
  selected_arguments_data[1] = (all + tile_groups_per_row - 1u) / tile_groups_per_row;
  selected_arguments_data[2] = 1u;
  counters.sample_demand = sum_chunks(0u, 0u);
}

void main() {
  uint lane = gl_LocalInvocationIndex, tiles = uint(frame.tiles.x * frame.tiles.y);
  uint first = min(gl_WorkGroupID.x * tiles_per_run_group + lane * run, tiles);
  uint last = min(first + run, tiles);
  if (lane == 0u) {
    listed = 0u;
    last_bin = ivec2(-1);
    left = uvec2(0u);
  }
  uint entries[run], bins[run]; // read first, because no read depends on another
  uint priorities[run];
  [[unroll]] for (uint i = 0u; i < run; ++i) {
    uint tile = min(first + i, tiles - 1u);
    entries[i] = classes_data[tile];
    priorities[i] = tile_changes_data[tile];
    uint bin = selection_bin(entries[i], priorities[i]);
    bins[i] = first + i < last ? bin : no_bin;
  }
  sum_histograms(lane);
  find_thresholds(lane);

  uvec2 own = uvec2(0u); // tiles in the last bins
  [[unroll]] for (uint i = 0u; i < run; ++i) {
    own.x += int(bins[i]) == last_bin.x ? 1u : 0u;
    own.y += int(bins[i]) == last_bin.y && !is_kept(priorities[i]) ? 1u : 0u;
  }
  own *= uvec2(last_bin.x >= 0, last_bin.y >= 0); // no_bin equals -1
  uvec2 earlier = sum_before(lane, own);
  earlier.x += last_bin.x >= 0 ? earlier_of_bin[last_bin.x] : 0u;
  earlier.y += last_bin.y >= 0 ? earlier_of_bin[selection_bins + uint(last_bin.y)] : 0u;
  uint taking = 0u;
  bool taken[run];
  [[unroll]] for (uint i = 0u; i < run; ++i) {
    taken[i] = false;
    if (first + i >= last)
      continue;
    uint tile = first + i;
    if (bins[i] == no_bin) {
      tile_states_data[tile] = state_not_scattering;
      continue;
    }
    bool stays = is_paid(0u, bins[i], earlier);
    bool kept = is_kept(priorities[i]), affordable = kept || is_paid(1u, bins[i], earlier);
    uint state = state_of(kept, stays, affordable);
    uint level = priorities[i] >> selection_level_shift & max_selection_level;
    tile_states_data[tile] = state | level << state_bits;
    taken[i] = is_listed(state);
    if (taken[i])
      ++taking;
    else
      classes_data[tile] = class_copy | (entries[i] & class_full_bit);
  }
  uint at = taking > 0u ? atomicAdd(listed, taking) : 0u;
  barrier();
  if (lane == 0u && listed > 0u)
    base = atomicAdd(list_state_data[0], listed);
  barrier();
  if (lane == 0u && ends_last())
    write_arguments();
  at += base;
  uint across = uint(frame.tiles.x);
  uvec2 place = uvec2(first % across, first / across);
  [[unroll]] for (uint i = 0u; i < run; ++i) {
    if (taken[i])
      selected_tiles_data[1u + at++] = place.x | place.y << 15;
    place = place.x + 1u < across ? place + uvec2(1u, 0u) : uvec2(0u, place.y + 1u);
  }
  if (lane == 0u && listed > 0u)
    atomicAdd(counters.sample_units, listed);
}
