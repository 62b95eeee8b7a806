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
layout(local_size_x = 128, local_size_y = 1, local_size_z = 1) in;

shared uint cost_of_bin[allocation_bins];    // of all tiles
shared uint earlier_of_bin[allocation_bins]; // of the tiles of earlier groups
shared uint counts[lanes];
shared int last_bin;    // bins above are paid in full, bins below not at all
shared uint last_units; // units for the tiles of this bin
shared uint listed;     // tiles of the group
shared uint base;       // index of the first of them in the list
shared uint units_sum;
shared uint tiles_by_steps[allocation_steps];
shared bool is_last;

struct tile_steps {
  uint bins[allocation_steps];
};
tile_steps steps_of(uint tile) {
  tile_steps steps;
  bool scatters = class_of_tile(classes_data[tile]) == class_scatter;
  uint tile_error = scatters ? tile_errors_data[tile] : 0u;
  uint before = has_before() ? before_data[tile] : 0u;
  for (int k = 0; k < allocation_steps; ++k)
    steps.bins[k] = step_bin(tile_error, k, before);
  return steps;
}

// Sums the costs by bin, from the sums of each run if another pass has made them.
void sum_costs(uint lane, uint first, uint tiles) {
  for (uint bin = lane; bin < allocation_bins; bin += lanes) {
    uint all = 0u, earlier = 0u;
    for (uint group = 0u; has_demand() && group < list_groups(); ++group) {
      uint cost = demand_data[group * allocation_bins + bin];
      all += cost;
      earlier += group < gl_WorkGroupID.x ? cost : 0u;
    }
    cost_of_bin[bin] = all;
    earlier_of_bin[bin] = earlier;
  }
  barrier();
  for (uint tile = lane; !has_demand() && tile < tiles; tile += lanes) {
    tile_steps steps = steps_of(tile);
    for (int k = 0; k < allocation_steps; ++k) {
      if (steps.bins[k] == no_bin)
        continue;
      atomicAdd(cost_of_bin[steps.bins[k]], step_cost(k));
      if (tile < first)
        atomicAdd(earlier_of_bin[steps.bins[k]], step_cost(k));
    }
  }
  barrier();
}

void find_last_bin() {
  uint left = frame.sample_units;
  last_bin = -1;
  last_units = 0u;
  for (int bin = int(allocation_bins) - 1; bin >= 0; --bin) {
    if (cost_of_bin[bin] > left) {
      last_bin = bin;
      last_units = left;
      return;
    }
    left -= cost_of_bin[bin];
  }
}

// Returns the steps that a tile takes. `spent` counts the units of the last bin that earlier tiles
// requested.
uint take_steps(tile_steps tile, inout uint spent, inout uint units) {
  uint steps = 0u;
  for (int k = 0; k < allocation_steps; ++k) {
    uint bin = tile.bins[k];
    if (bin == no_bin)
      break;
    bool taken = int(bin) > last_bin;
    if (int(bin) == last_bin) {
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

void write_arguments() {
  uint all = atomicExchange(list_state_data[0], 0u), demand = 0u;
  list_state_data[state_ended] = 0u;
  tiles_data[0] = all;
  arguments_data[0] = min(all, tile_groups_per_row);
  arguments_data[1] = (all + tile_groups_per_row - 1u) / tile_groups_per_row;
  arguments_data[2] = 1u;
  for (uint bin = 0u; bin < allocation_bins; ++bin)
    demand += cost_of_bin[bin];
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
  sum_costs(lane, group_first, tiles);
  if (lane == 0u)
    find_last_bin();
  barrier();

  uint own = 0u; // cost of own steps in the last bin
  for (uint tile = first; tile < last; ++tile) {
    tile_steps steps = steps_of(tile);
    for (int k = 0; k < allocation_steps; ++k)
      own += int(steps.bins[k]) == last_bin ? step_cost(k) : 0u;
  }
  counts[lane] = own;
  barrier();
  for (uint stride = 1u; stride < lanes; stride *= 2u) { // inclusive scan, Hillis & Steele 1986
    uint before = lane >= stride ? counts[lane - stride] : 0u;
    barrier();
    counts[lane] += before;
    barrier();
  }

  uint spent = counts[lane] - own + (last_bin >= 0 ? earlier_of_bin[last_bin] : 0u);
  uint units = 0u, taking = 0u, steps_by_tile[run];
  [[unroll]] for (uint i = 0u; i < run; ++i) {
    uint tile = first + i;
    steps_by_tile[i] = 0u;
    if (tile >= last)
      continue;
    steps_by_tile[i] = take_steps(steps_of(tile), spent, units);
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
  if (lane == 0u && listed > 0u) {
    base = atomicAdd(list_state_data[0], listed);
    atomicAdd(counters.sample_units, units_sum);
  }
  if (lane < uint(allocation_steps) && tiles_by_steps[lane] > 0u)
    atomicAdd(counters.sampled_tiles[lane], tiles_by_steps[lane]);
  barrier();
  at += base;
  uint across = uint(frame.tiles.x);
  uvec2 tile = uvec2(first % across, first / across);
  [[unroll]] for (uint i = 0u; i < run; ++i) {
    if (steps_by_tile[i] > 0u)
      tiles_data[1u + at++] = tile.x | tile.y << 15;
    tile = tile.x + 1u < across ? tile + uvec2(1u, 0u) : uvec2(0u, tile.y + 1u);
  }
  if (last_group() && lane == 0u)
    write_arguments();
}
