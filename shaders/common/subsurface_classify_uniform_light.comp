#version 460
// Marks tiles whose light is uniform as far as light reaches: they keep their own light, because as
// much light scatters into a pixel as out of it.
// One invocation handles a tile. It first checks the corners of the reach, where most tiles with
// other light fail, then the cells of 4x4 tiles around. A cell that differs may lie partly beyond
// the reach; in this case the invocation checks its tiles. Ranges are read in batches, because a
// tile may read hundreds of them. An invocation writes only the class of its own tile, which no
// other invocation reads.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "common/subsurface_classify_uniform_light.bindings.glsl"
#include "common/environment.glsl"
#include "constants.glsl"
#include "common/counters.glsl"
#include "common/light_range.glsl"
#include "common/tile_packing.glsl"

layout(local_size_x = 64, local_size_y = 1, local_size_z = 1) in;

const int side = int(uniform_cell_side);
const int batch = 4; // ranges that are read at once

shared uint uniform_tiles, uniform_steps; // of the group

// A tile's light, and the tiles within its reach.
struct lit_tile {
  vec3 low, high;
  ivec2 first, last;
};

int index_of(ivec2 tile) { return tile.y * frame.tiles.x + tile.x; }

bool corners_alike(lit_tile own) {
  uvec4 ranges[4];
  [[unroll]] for (int i = 0; i < 4; ++i)
    ranges[i] = light_range_data[index_of(ivec2(i % 2 == 0 ? own.first.x : own.last.x,
                                                i / 2 == 0 ? own.first.y : own.last.y))];
  bool alike = true;
  [[unroll]] for (int i = 0; i < 4; ++i)
    alike = alike && is_alike(ranges[i], own.low, own.high);
  return alike;
}

// Returns whether the tiles of a cell that are within the reach are alike.
bool tiles_alike(lit_tile own, ivec2 cell) {
  bool alike = true;
  [[dont_unroll]] for (int row = 0; row < side && alike; ++row) {
    uvec4 ranges[side];
    // Tiles beyond the reach count as the nearest one within it.
    [[unroll]] for (int i = 0; i < side; ++i) {
      ivec2 tile = clamp(side * cell + ivec2(i, row), own.first, own.last);
      ranges[i] = light_range_data[index_of(tile)];
    }
    [[unroll]] for (int i = 0; i < side; ++i)
      alike = alike && is_alike(ranges[i], own.low, own.high);
  }
  return alike;
}

// Returns whether all tiles of a column or row of cells are within the reach along an axis.
bool is_whole(int cell, int first, int last, int tiles) {
  return side * cell >= first && min(side * cell + side, tiles) - 1 <= last;
}

// Returns whether the tiles within the reach are alike in a row of cells.
bool row_alike(lit_tile own, int row) {
  int across = (frame.tiles.x + side - 1) / side;
  int begin = own.first.x / side, end = own.last.x / side;
  bool whole_row = is_whole(row, own.first.y, own.last.y, frame.tiles.y);
  bool alike = true;
  [[dont_unroll]] for (int x = begin; x <= end && alike; x += batch) {
    uvec4 ranges[batch], all;
    [[unroll]] for (int i = 0; i < batch; ++i) {
      ranges[i] = light_cells_data[row * across + min(x + i, end)];
      all = i == 0 ? ranges[i] : join_ranges(all, ranges[i]);
    }
    if (is_alike(all, own.low, own.high))
      continue;
    uint open = 0u; // a bit for each cell whose tiles decide
    [[unroll]] for (int i = 0; i < batch; ++i) {
      int cell = min(x + i, end);
      bool whole = whole_row && is_whole(cell, own.first.x, own.last.x, frame.tiles.x);
      open |= is_alike(ranges[i], own.low, own.high) ? 0u : 1u << uint(i);
      alike = alike && !(whole && has_unlike(ranges[i], own.low, own.high));
    }
    [[dont_unroll]] while (open != 0u && alike) {
      alike = tiles_alike(own, ivec2(min(x + findLSB(open), end), row));
      open &= open - 1u;
    }
  }
  return alike;
}

bool reach_alike(lit_tile own) {
  bool alike = corners_alike(own);
  int last = own.last.y / side;
  [[dont_unroll]] for (int row = own.first.y / side; row <= last && alike; ++row)
    alike = row_alike(own, row);
  return alike;
}

void main() {
  if (gl_LocalInvocationIndex == 0u)
    uniform_tiles = uniform_steps = 0u;
  barrier();
  int index = int(gl_GlobalInvocationID.x), near = min(index, frame.tiles.x * frame.tiles.y - 1);
  uint entry = classes_data[near];
  uvec4 range = light_range_data[near];
  lit_tile own;
  unpack_range(range, own.low, own.high);
  float d_px = uintBitsToFloat(range.w);
  int reach = uniform_reach(d_px);
  if (index == near && class_of_tile(entry) == class_scatter && reach <= uniform_max_reach &&
      is_alike(range, own.low, own.high)) {
    ivec2 tile = ivec2(index % frame.tiles.x, index / frame.tiles.x);
    own.first = max(tile - reach, ivec2(0));
    own.last = min(tile + reach, frame.tiles - 1);
    if (reach_alike(own)) {
      classes_data[index] = class_uniform | (entry & class_full_bit);
      atomicAdd(uniform_tiles, 1u);
      atomicAdd(uniform_steps, counter_steps(d_px));
    }
  }
  barrier();
  if (gl_LocalInvocationIndex == 0u && uniform_tiles != 0u)
    recount_as_uniform(uniform_tiles, uniform_steps);
}
