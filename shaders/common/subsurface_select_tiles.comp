#version 460
// Selects the tiles that scatter, as many as the frame's budget allows, and lists them; the others
// become tiles that are copied. A group handles a run of tiles in row order. Adds the histograms of
// all runs to find the two thresholds: for tiles with a weight, and for tiles that enter. Integer
// sums only, so that equal changes give equal selections.
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
layout(local_size_x = 128, local_size_y = 1, local_size_z = 1) in;

// Index 0: all tiles. Index 1: tiles without a weight in the previous frame.
shared uint tiles_of_bin[2u * selection_bins];
shared uint earlier_of_bin[2u * selection_bins]; // of earlier groups
shared uvec2 counts[lanes];
shared uint sums[2];
// Bins above are paid in full, and the first `left` tiles of the bin.
shared ivec2 last_bin;
shared uvec2 left;
shared bool fades;
shared uint listed; // tiles of the group
shared uint base;   // index of the first of them in the list
shared bool is_last;

void sum_histograms(uint lane) {
  for (uint bin = lane; bin < 2u * selection_bins; bin += lanes) {
    uint all = 0u, earlier = 0u;
    for (uint group = 0u; group < list_groups(); ++group) {
      uint tiles = histogram_data[group * 2u * selection_bins + bin];
      all += tiles;
      earlier += group < gl_WorkGroupID.x ? tiles : 0u;
    }
    tiles_of_bin[bin] = all;
    earlier_of_bin[bin] = earlier;
    atomicAdd(sums[bin / selection_bins], all);
  }
}

void find_threshold(uint which, uint units) {
  last_bin[which] = -1;
  left[which] = 0u;
  for (int bin = int(selection_bins) - 1; bin >= 0; --bin) {
    uint tiles = tiles_of_bin[which * selection_bins + uint(bin)];
    if (tiles > units) {
      last_bin[which] = bin;
      left[which] = units;
      return;
    }
    units -= tiles;
  }
}

void find_thresholds(uint lane) {
  uint demand = sums[0], chosen = demand - sums[1];
  bool may_fade = chosen <= frame.sample_units;
  if (lane == 0u) {
    fades = may_fade;
    find_threshold(0u, steady_units(frame.sample_units, demand));
  }
  if (lane == 1u)
    find_threshold(1u, may_fade ? frame.sample_units - chosen : 0u);
}

// Returns whether a tile of this bin is paid. `earlier` counts the tiles of the last bin so far.
bool is_paid(uint which, uint bin, inout uvec2 earlier) {
  if (int(bin) != last_bin[which])
    return int(bin) > last_bin[which];
  return earlier[which]++ < left[which];
}

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

void main() {
  uint lane = gl_LocalInvocationIndex, tiles = uint(frame.tiles.x * frame.tiles.y);
  uint first = min(gl_WorkGroupID.x * tiles_per_run_group + lane * run, tiles);
  uint last = min(first + run, tiles);
  bool continues = has_before() && history_usable();
  if (lane < 2u)
    sums[lane] = 0u;
  if (lane == 0u)
    listed = 0u;
  barrier();
  sum_histograms(lane);
  barrier();
  find_thresholds(lane);
  barrier();

  uint bins[run], before[run];
  uvec2 own = uvec2(0u); // tiles in the last bins
  [[unroll]] for (uint i = 0u; i < run; ++i) {
    uint tile = min(first + i, tiles - 1u);
    before[i] = continues ? before_data[tile] : 0u;
    bins[i] = first + i < last
                  ? selection_bin(classes_data[tile], tile_changes_data[tile], before[i])
                  : no_bin;
    own.x += int(bins[i]) == last_bin.x ? 1u : 0u;
    own.y += int(bins[i]) == last_bin.y && !is_chosen(before[i]) ? 1u : 0u;
  }
  own *= uvec2(last_bin.x >= 0, last_bin.y >= 0); // no_bin equals -1
  counts[lane] = own;
  barrier();
  for (uint stride = 1u; stride < lanes; stride *= 2u) { // inclusive scan, Hillis & Steele 1986
    uvec2 others = lane >= stride ? counts[lane - stride] : uvec2(0u);
    barrier();
    counts[lane] += others;
    barrier();
  }

  uvec2 earlier = counts[lane] - own;
  earlier.x += last_bin.x >= 0 ? earlier_of_bin[last_bin.x] : 0u;
  earlier.y += last_bin.y >= 0 ? earlier_of_bin[selection_bins + uint(last_bin.y)] : 0u;
  uint weights[run], taking = 0u;
  [[unroll]] for (uint i = 0u; i < run; ++i) {
    weights[i] = 0u;
    if (first + i >= last)
      continue;
    uint tile = first + i;
    if (bins[i] == no_bin) {
      tile_weights_data[tile] = not_scattering;
      continue;
    }
    bool stays = is_paid(0u, bins[i], earlier);
    bool affordable = !is_chosen(before[i]) && is_paid(1u, bins[i], earlier);
    weights[i] = next_weight(before[i], stays, stays && affordable, fades, continues);
    tile_weights_data[tile] = weights[i];
    if (weights[i] > 0u)
      ++taking;
    else
      classes_data[tile] = class_copy | (classes_data[tile] & class_full_bit);
  }
  uint at = taking > 0u ? atomicAdd(listed, taking) : 0u;
  barrier();
  if (lane == 0u && listed > 0u) {
    base = atomicAdd(list_state_data[0], listed);
    atomicAdd(counters.sample_units, listed);
  }
  barrier();
  at += base;
  uint across = uint(frame.tiles.x);
  uvec2 place = uvec2(first % across, first / across);
  [[unroll]] for (uint i = 0u; i < run; ++i) {
    if (weights[i] > 0u)
      selected_tiles_data[1u + at++] = place.x | place.y << 15;
    place = place.x + 1u < across ? place + uvec2(1u, 0u) : uvec2(0u, place.y + 1u);
  }
  if (!last_group() || lane != 0u)
    return;
  uint all = atomicExchange(list_state_data[0], 0u);
  list_state_data[state_ended] = 0u;
  selected_tiles_data[0] = all;
  selected_arguments_data[0] = min(all, tile_groups_per_row);
  selected_arguments_data[1] = (all + tile_groups_per_row - 1u) / tile_groups_per_row;
  selected_arguments_data[2] = 1u;
  counters.sample_demand = sums[0];
}
