#version 460
// Allocates samples to tiles until the frame's budget is spent. Sorts benefit over cost into 256
// logarithmic bins, scans over the bins, and scans over the tiles in row order in the bin where the
// budget ends. One group; integer sums only, so that equal error estimates give equal allocations.
// Each invocation owns a run of consecutive tiles.
#extension GL_GOOGLE_include_directive : require
#include "sap/subsurface_allocate_samples.bindings.glsl"
#include "common/environment.glsl"
#include "constants.glsl"
#include "common/counters.glsl"
#include "common/tile_packing.glsl"
#include "sap/sample_allocation.glsl"

const uint lanes = 128u;
layout(local_size_x = 128, local_size_y = 1, local_size_z = 1) in;

shared uint cost_of_bin[allocation_bins];
shared uint counts[lanes];
shared int last_bin;    // bins above are paid in full, bins below not at all
shared uint last_units; // units for the tiles of this bin

uint tile_error_of(uint tile) {
  return class_of_tile(classes_data[tile]) == class_scatter ? tile_errors_data[tile] : 0u;
}
uint steps_before(uint tile) { return has_before() ? before_data[tile] : 0u; }

// Inclusive scan, Hillis & Steele 1986.
void scan(uint lane) {
  barrier();
  for (uint stride = 1u; stride < lanes; stride *= 2u) {
    uint before = lane >= stride ? counts[lane - stride] : 0u;
    barrier();
    counts[lane] += before;
    barrier();
  }
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
uint take_steps(uint tile, inout uint spent, inout uint units) {
  uint steps = 0u;
  for (int k = 0; k < allocation_steps; ++k) {
    uint bin = step_bin(tile_error_of(tile), k, steps_before(tile));
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

void main() {
  uint lane = gl_LocalInvocationIndex;
  uint total = uint(frame.tiles.x * frame.tiles.y);
  uint run = (total + lanes - 1u) / lanes;
  uint first = min(lane * run, total), last = min(first + run, total);

  for (uint bin = lane; bin < allocation_bins; bin += lanes)
    cost_of_bin[bin] = 0u;
  barrier();
  for (uint i = first; i < last; ++i)
    for (int k = 0; k < allocation_steps; ++k) {
      uint bin = step_bin(tile_error_of(i), k, steps_before(i));
      if (bin != no_bin)
        atomicAdd(cost_of_bin[bin], step_cost(k));
    }
  barrier();
  if (lane == 0u)
    find_last_bin();
  barrier();

  uint own = 0u; // cost of own steps in the last bin
  for (uint i = first; i < last; ++i)
    for (int k = 0; k < allocation_steps; ++k)
      if (int(step_bin(tile_error_of(i), k, steps_before(i))) == last_bin)
        own += step_cost(k);
  counts[lane] = own;
  scan(lane);
  uint spent = counts[lane] - own;
  barrier();

  uint listed = 0u, units = 0u, at_first = spent;
  for (uint i = first; i < last; ++i) {
    uint steps = take_steps(i, spent, units);
    samples_per_tile_data[i] = steps;
    if (steps > 0u) {
      ++listed;
      atomicAdd(counters.sampled_tiles[steps - 1u], 1u);
    }
  }
  atomicAdd(counters.sample_units, units);
  counts[lane] = listed;
  scan(lane);
  uint at = counts[lane] - listed;
  for (uint i = first; i < last; ++i)
    if (take_steps(i, at_first, units) > 0u)
      tiles_data[1u + at++] = i % uint(frame.tiles.x) | (i / uint(frame.tiles.x)) << 15;
  if (lane == lanes - 1u) {
    listed = counts[lane];
    tiles_data[0] = listed;
    arguments_data[0] = min(listed, tile_groups_per_row);
    arguments_data[1] = (listed + tile_groups_per_row - 1u) / tile_groups_per_row;
    arguments_data[2] = 1u;
  }
  if (lane == 0u) {
    uint demand = 0u;
    for (uint bin = 0u; bin < allocation_bins; ++bin)
      demand += cost_of_bin[bin];
    counters.sample_demand = demand;
  }
}
