#version 460
// Allocates samples to tiles until the frame's budget is spent. Adds the costs of all runs of tiles
// by bin, and finds the bin where the budget ends, which is served in row order. A group allocates
// the samples of a run of tiles and appends its tiles to the list. Integer sums only, so that equal
// error estimates give equal allocations.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "sap/subsurface_allocate_samples.bindings.glsl"
#include "common/environment.glsl"
#include "constants.glsl"
#include "common/counters.glsl"
#include "common/list_state.glsl"
#include "common/tile_packing.glsl"
#include "sap/sample_allocation.glsl"

const uint lanes = 128u;
const uint run = tiles_per_run_group / lanes; // tiles of an invocation
const uint own_bins = allocation_bins / lanes;
const uint batch = 16u; // runs whose costs an invocation reads at once
// Sums take two steps: an invocation first adds the values of a chunk.
const uint chunk = 16u, bin_chunks = allocation_bins / chunk, lane_chunks = lanes / chunk;
layout(local_size_x = 128, local_size_y = 1, local_size_z = 1) in;

shared uint cost_of_bin[allocation_bins];    // of all tiles
shared uint earlier_of_bin[allocation_bins]; // of the tiles of earlier groups
shared uint cost_of_chunk[bin_chunks];
shared uint counts[lanes], counts_of_chunk[lane_chunks];
shared int last_bin;    // bins above are paid in full, bins below not at all
shared uint last_units; // units for the tiles of this bin
shared uint listed;     // tiles of the group
shared uint base;       // index of the first of them in the list
shared uint units_sum;
shared uint tiles_by_steps[allocation_steps];

// Returns the bins of the steps of a tile, one per byte; no_bin if the tile takes no steps.
uint bins_of(uint tile) {
  uint entry = classes_data[tile], tile_error = tile_errors_data[tile];
  uint before = has_before() ? before_data[previous_tile(tile)] : 0u, bins = 0u;
  for (int k = 0; k < allocation_steps; ++k)
    bins |= step_bin(tile_error, k, before) << uint(8 * k);
  return class_of_tile(entry) == class_scatter && tile_error > 0u ? bins : no_bin;
}
uint bin_of_step(uint bins, int k) { return bins >> uint(8 * k) & 0xffu; }

// Sums the costs by bin, from the sums of each run if another pass has made them.
void sum_costs(uint lane, uint first, uint tiles) {
  uint all[own_bins], earlier[own_bins];
  [[unroll]] for (uint i = 0u; i < own_bins; ++i)
    all[i] = earlier[i] = 0u;
  uint groups = has_demand() ? list_groups() : 0u;
  [[dont_unroll]] for (uint group = 0u; group < groups; group += batch) {
    uint costs[batch * own_bins];
    [[unroll]] for (uint i = 0u; i < batch * own_bins; ++i)
      costs[i] = demand_data[min(group + i / own_bins, groups - 1u) * allocation_bins +
                             i % own_bins * lanes + lane];
    [[unroll]] for (uint i = 0u; i < batch * own_bins; ++i) {
      uint at = group + i / own_bins;
      all[i % own_bins] += at < groups ? costs[i] : 0u;
      earlier[i % own_bins] += at < gl_WorkGroupID.x ? costs[i] : 0u;
    }
  }
  [[unroll]] for (uint i = 0u; i < own_bins; ++i) {
    cost_of_bin[i * lanes + lane] = all[i];
    earlier_of_bin[i * lanes + lane] = earlier[i];
  }
  barrier();
  if (has_demand())
    return;
  for (uint tile = lane; tile < tiles; tile += lanes) {
    uint bins = bins_of(tile);
    for (int k = 0; k < allocation_steps && bins != no_bin; ++k) {
      atomicAdd(cost_of_bin[bin_of_step(bins, k)], step_cost(k));
      if (tile < first)
        atomicAdd(earlier_of_bin[bin_of_step(bins, k)], step_cost(k));
    }
  }
  barrier();
}

// Finds the bin where the budget ends. First finds its chunk.
void find_last_bin(uint lane) {
  if (lane == 0u) {
    last_bin = -1;
    last_units = 0u;
  }
  if (lane < bin_chunks) {
    uint sum = 0u;
    [[unroll]] for (uint i = 0u; i < chunk; ++i)
      sum += cost_of_bin[lane * chunk + i];
    cost_of_chunk[lane] = sum;
  }
  barrier();
  uint above = 0u;
  [[unroll]] for (uint i = 0u; i < bin_chunks; ++i)
    above += i > lane ? cost_of_chunk[i] : 0u;
  if (lane < bin_chunks && above <= frame.sample_units &&
      cost_of_chunk[lane] > frame.sample_units - above) {
    uint left = frame.sample_units - above, bin = (lane + 1u) * chunk - 1u;
    for (; cost_of_bin[bin] <= left; --bin)
      left -= cost_of_bin[bin];
    last_bin = int(bin);
    last_units = left;
  }
  barrier();
}

// Returns the sum of the values of earlier invocations.
uint sum_before(uint lane, uint value) {
  counts[lane] = value;
  barrier();
  if (lane < lane_chunks) {
    uint sum = 0u;
    [[unroll]] for (uint i = 0u; i < chunk; ++i)
      sum += counts[lane * chunk + i];
    counts_of_chunk[lane] = sum;
  }
  barrier();
  uint sum = 0u, own_chunk = lane / chunk;
  [[unroll]] for (uint i = 0u; i < lane_chunks; ++i)
    sum += i < own_chunk ? counts_of_chunk[i] : 0u;
  [[unroll]] for (uint i = 0u; i < chunk; ++i)
    sum += i < lane % chunk ? counts[own_chunk * chunk + i] : 0u;
  return sum;
}

// Returns the steps that a tile takes. `spent` counts the units of the last bin that earlier tiles
// requested.
uint take_steps(uint bins, inout uint spent, inout uint units) {
  uint steps = 0u;
  for (int k = 0; k < allocation_steps && bins != no_bin; ++k) {
    int bin = int(bin_of_step(bins, k));
    bool taken = bin > last_bin;
    if (bin == last_bin) {
      spent += step_cost(k);
      taken = spent <= last_units;
    }
    if (!taken)
      break; // later steps have less benefit per cost
    ++steps;
    units += step_cost(k);
  }
  return steps;
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
  uint all = atomicExchange(list_state_data[0], 0u), demand = 0u;
  list_state_data[state_ended] = 0u;
  tiles_data[0] = all;
  arguments_data[0] = min(all, tile_groups_per_row);
  arguments_data[1] = (all + tile_groups_per_row - 1u) / tile_groups_per_row;
  arguments_data[2] = 1u;
  [[unroll]] for (uint i = 0u; i < bin_chunks; ++i)
    demand += cost_of_chunk[i];
  counters.sample_demand = demand;
}

void main() {
  uint lane = gl_LocalInvocationIndex, tiles = uint(frame.tiles.x * frame.tiles.y);
  uint group_first = gl_WorkGroupID.x * tiles_per_run_group;
  uint first = min(group_first + lane * run, tiles), last = min(first + run, tiles);
  if (lane < uint(allocation_steps))
    tiles_by_steps[lane] = 0u;
  if (lane == 0u) {
    listed = 0u;
    units_sum = 0u;
  }
  uint bins[run]; // read first, because no read depends on another
  [[unroll]] for (uint i = 0u; i < run; ++i) {
    uint of_tile = bins_of(min(first + i, tiles - 1u));
    bins[i] = first + i < last ? of_tile : no_bin;
  }
  sum_costs(lane, group_first, tiles);
  find_last_bin(lane);

  uint own = 0u; // cost of own steps in the last bin
  [[unroll]] for (uint i = 0u; i < run; ++i)
    for (int k = 0; k < allocation_steps; ++k)
      own += bins[i] != no_bin && int(bin_of_step(bins[i], k)) == last_bin ? step_cost(k) : 0u;
  uint spent = sum_before(lane, own) + (last_bin >= 0 ? earlier_of_bin[last_bin] : 0u);
  uint units = 0u, taking = 0u, steps_by_tile[run];
  [[unroll]] for (uint i = 0u; i < run; ++i) {
    uint tile = first + i;
    steps_by_tile[i] = 0u;
    if (tile >= last)
      continue;
    steps_by_tile[i] = take_steps(bins[i], spent, units);
    samples_per_tile_data[tile] = steps_by_tile[i];
    if (steps_by_tile[i] > 0u) {
      ++taking;
      atomicAdd(tiles_by_steps[steps_by_tile[i] - 1u], 1u);
    }
  }
  uint at = taking > 0u ? atomicAdd(listed, taking) : 0u;
  if (units > 0u)
    atomicAdd(units_sum, units);
  barrier();
  if (lane == 0u && listed > 0u)
    base = atomicAdd(list_state_data[0], listed);
  barrier();
  if (lane == 0u && ends_last())
    write_arguments();
  at += base;
  uint across = uint(frame.tiles.x);
  uvec2 tile = uvec2(first % across, first / across);
  [[unroll]] for (uint i = 0u; i < run; ++i) {
    if (steps_by_tile[i] > 0u)
      tiles_data[1u + at++] = tile.x | tile.y << 15;
    tile = tile.x + 1u < across ? tile + uvec2(1u, 0u) : uvec2(0u, tile.y + 1u);
  }
  if (lane == 0u && units_sum > 0u)
    atomicAdd(counters.sample_units, units_sum);
  if (lane < uint(allocation_steps) && tiles_by_steps[lane] > 0u)
    atomicAdd(counters.sampled_tiles[lane], tiles_by_steps[lane]);
}
