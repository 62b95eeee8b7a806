#version 460
// Lists the tiles where the separable technique runs next to tiles with samples of another
// technique. The vertical pass runs in tiles without samples and in tiles whose samples fade out
// towards them. The horizontal pass runs in the tiles that the vertical pass reads.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "separable/subsurface_separable_tiles.bindings.glsl"
#include "common/environment.glsl"
#include "common/list_state.glsl"
#include "common/tile_edges.glsl"
#include "common/tile_packing.glsl"
#include "separable/kernel.glsl"

layout(local_size_x = 64, local_size_y = 1, local_size_z = 1) in;

const int vertical_list = 0, horizontal_list = 1; // words of the list's state

// Tiles that an invocation reads: three columns of five rows around its tile.
const int columns = 3, rows = 5;
const int batch = 4;       // tiles that an invocation marks at once
const int round_rows = 32; // tiles that it marks before the group lists them

shared uint vertical, horizontal;             // tiles of the group
shared uint first_vertical, first_horizontal; // their first places in the lists
shared uint max_rows;                        // that an invocation marks

int index_of(ivec2 tile) { return tile.y * frame.tiles.x + tile.x; }

// Returns whether the vertical pass runs in the tile of row `row` of the middle column. `none` and
// `sampled` have a bit for each tile: no subsurface, and has_samples. `unsampled`: no samples.
bool runs_vertical(int row, uint none, uint sampled, uint unsampled) {
  uint at = uint(row * columns + 1);
  const uint around = (1u << uint(edge_tiles)) - 1u;
  if ((none >> at & 1u) != 0u)
    return false;
  return (unsampled >> at & 1u) != 0u ||
         (sampled >> uint((row - 1) * columns) & around) != around;
}

// Returns the number of tiles above and below that the vertical pass of a tile reads.
int reach_of(uint entry, uint tile_d) {
  return class_of_tile(entry) == class_scatter
             ? (separable_reach(settings.taps, uintBitsToFloat(tile_d)) + 7) / 8
             : 0;
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
  uint vertical = atomicExchange(list_state_data[vertical_list], 0u);
  uint horizontal = atomicExchange(list_state_data[horizontal_list], 0u);
  list_state_data[state_ended] = 0u;
  vertical_tiles_data[0] = vertical;
  vertical_arguments_data[0] = min(vertical, tile_groups_per_row);
  vertical_arguments_data[1] = (vertical + tile_groups_per_row - 1u) / tile_groups_per_row;
  vertical_arguments_data[2] = 1u;
  horizontal_tiles_data[0] = horizontal;
  horizontal_arguments_data[0] = min(horizontal, tile_groups_per_row);
  horizontal_arguments_data[1] = (horizontal + tile_groups_per_row - 1u) / tile_groups_per_row;
  horizontal_arguments_data[2] = 1u;
}

// Marks tiles that the horizontal pass runs in: rows `from` to `to` of a column of tiles, at most
// round_rows. Returns a bit for each tile that was not marked before.
uint mark(int column, int from, int to) {
  uint fresh = 0u;
  [[dont_unroll]] for (int row = from; row <= to; row += batch) {
    uint entries[batch];
    [[unroll]] for (int i = 0; i < batch; ++i)
      entries[i] = classes_data[index_of(ivec2(column, min(row + i, to)))];
    [[unroll]] for (int i = 0; i < batch; ++i) {
      bool needed = row + i <= to && class_of_tile(entries[i]) != class_none;
      if (needed && atomicOr(needed_data[index_of(ivec2(column, row + i))], 1u) == 0u)
        fresh |= 1u << uint(row + i - from);
    }
  }
  return fresh;
}

void main() {
  int index = int(gl_GlobalInvocationID.x);
  uint lane = gl_LocalInvocationIndex;
  ivec2 tile = ivec2(index % frame.tiles.x, index / frame.tiles.x);
  uint none = 0u, sampled = 0u, unsampled = 0u;
  int reaches[rows];
  [[unroll]] for (int i = 0; i < columns * rows; ++i) {
    ivec2 near = tile + ivec2(i % columns - 1, i / columns - 2);
    int at = index_of(clamp(near, ivec2(0), frame.tiles - 1));
    uint entry = classes_data[at], samples = samples_per_tile_data[at];
    none |= class_of_tile(entry) == class_none ? 1u << uint(i) : 0u;
    sampled |= has_samples(entry, samples) ? 1u << uint(i) : 0u;
    unsampled |= samples == 0u ? 1u << uint(i) : 0u;
    if (i % columns == 1)
      reaches[i / columns] = reach_of(entry, tile_d_data[at]);
  }
  bool runs = tile.y < frame.tiles.y && runs_vertical(2, none, sampled, unsampled);
  int above = min(reaches[2], tile.y), below = min(reaches[2], frame.tiles.y - 1 - tile.y);
  // If the vertical pass also runs in the next tile and reads as far, that tile's invocation marks
  // the tiles of that side.
  if (runs_vertical(1, none, sampled, unsampled) && reaches[1] >= above - 1)
    above = 0;
  if (runs_vertical(3, none, sampled, unsampled) && reaches[3] >= below - 1)
    below = 0;
  if (lane == 0u)
    vertical = horizontal = max_rows = 0u;
  barrier();
  uint at = runs ? atomicAdd(vertical, 1u) : 0u;
  if (runs)
    atomicMax(max_rows, uint(above + below + 1));
  barrier();
  if (lane == 0u && vertical > 0u)
    first_vertical = atomicAdd(list_state_data[vertical_list], vertical);
  int last = runs ? tile.y + below : -1, first = tile.y - above;
  for (int marked = 0; marked < int(max_rows); marked += round_rows) {
    int from = first + marked;
    uint fresh = mark(tile.x, from, min(last, from + round_rows - 1));
    uint place = fresh != 0u ? atomicAdd(horizontal, uint(bitCount(fresh))) : 0u;
    barrier();
    if (lane == 0u && horizontal > 0u) {
      first_horizontal = atomicAdd(list_state_data[horizontal_list], horizontal);
      horizontal = 0u;
    }
    barrier();
    place += first_horizontal;
    [[dont_unroll]] while (fresh != 0u) {
      ivec2 needed = ivec2(tile.x, from + findLSB(fresh));
      fresh &= fresh - 1u;
      horizontal_tiles_data[1u + place++] =
          pack_tile(uvec2(needed), classes_data[index_of(needed)]);
    }
  }
  if (lane == 0u && ends_last())
    write_arguments();
  if (runs)
    vertical_tiles_data[1u + first_vertical + at] = pack_tile(uvec2(tile), classes_data[index]);
}
