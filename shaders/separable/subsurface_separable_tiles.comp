#version 460
// Lists the tiles where the separable technique runs next to tiles with samples of another
// technique. The vertical pass runs in tiles without samples and in tiles whose samples fade out
// towards them. The horizontal pass runs in the tiles that the vertical pass reads.
#extension GL_GOOGLE_include_directive : require
#include "separable/subsurface_separable_tiles.bindings.glsl"
#include "common/environment.glsl"
#include "common/list_state.glsl"
#include "common/tile_edges.glsl"
#include "common/tile_packing.glsl"
#include "separable/kernel.glsl"

layout(local_size_x = 64, local_size_y = 1, local_size_z = 1) in;

const int vertical_list = 0, horizontal_list = 1; // words of the list's state

shared bool is_last;

int index_of(ivec2 tile) { return tile.y * frame.tiles.x + tile.x; }

bool runs_vertical(ivec2 tile) {
  int index = index_of(tile);
  if (class_of_tile(classes_data[index]) == class_none)
    return false;
  if (samples_per_tile_data[index] == 0u)
    return true;
  bool fades = false;
  for (int i = 0; i < edge_tiles; ++i) {
    int at = edge_tile(tile, i);
    fades = fades || !has_samples(classes_data[at], samples_per_tile_data[at]);
  }
  return fades;
}

// Returns the number of tiles above and below that the vertical pass of a tile reads.
int reach_of(ivec2 tile) {
  int index = index_of(tile);
  if (class_of_tile(classes_data[index]) != class_scatter)
    return 0;
  return (separable_reach(settings.taps, uintBitsToFloat(tile_d_data[index])) + 7) / 8;
}

void need_horizontal(ivec2 tile) {
  int index = index_of(tile);
  uint entry = classes_data[index];
  if (class_of_tile(entry) != class_none && atomicOr(needed_data[index], 1u) == 0u)
    horizontal_tiles_data[1u + atomicAdd(list_state_data[horizontal_list], 1u)] =
        pack_tile(uvec2(tile), entry);
}

// Marks the tiles that the vertical pass reads on one side. If it also runs in the next tile there
// and reads as far, that tile's invocation marks them.
void need_side(ivec2 tile, int side, int reach) {
  int last = side < 0 ? tile.y : frame.tiles.y - 1 - tile.y;
  reach = min(reach, last);
  if (reach == 0)
    return;
  ivec2 next = tile + ivec2(0, side);
  if (runs_vertical(next) && reach_of(next) >= reach - 1)
    return;
  for (int i = 1; i <= reach; ++i)
    need_horizontal(tile + ivec2(0, side * i));
}

void append(ivec2 tile) {
  vertical_tiles_data[1u + atomicAdd(list_state_data[vertical_list], 1u)] =
      pack_tile(uvec2(tile), classes_data[index_of(tile)]);
  need_horizontal(tile);
  int reach = reach_of(tile);
  need_side(tile, -1, reach);
  need_side(tile, 1, reach);
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

void main() {
  int index = int(gl_GlobalInvocationID.x);
  ivec2 tile = ivec2(index % frame.tiles.x, index / frame.tiles.x);
  if (tile.y < frame.tiles.y && runs_vertical(tile))
    append(tile);
  if (last_group() && gl_LocalInvocationIndex == 0u)
    write_arguments();
}
