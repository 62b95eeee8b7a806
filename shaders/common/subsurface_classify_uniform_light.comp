#version 460
// Marks tiles whose light is uniform as far as light reaches: they keep their own light, because as
// much light scatters into a pixel as out of it.
// One invocation handles a tile. It first checks the cells of 4x4 tiles around. A cell that differs
// may lie partly beyond the reach of light; in this case the invocation checks the tiles. An
// invocation writes only the class of its own tile, which no other invocation reads.
#extension GL_GOOGLE_include_directive : require
#include "common/subsurface_classify_uniform_light.bindings.glsl"
#include "common/environment.glsl"
#include "constants.glsl"
#include "common/counters.glsl"
#include "common/light_range.glsl"
#include "common/tile_packing.glsl"

layout(local_size_x = 64, local_size_y = 1, local_size_z = 1) in;

bool cells_alike(ivec2 first, ivec2 last, vec3 low, vec3 high) {
  int across = (frame.tiles.x + int(uniform_cell_side) - 1) / int(uniform_cell_side);
  ivec2 begin = first / int(uniform_cell_side), end = last / int(uniform_cell_side), cell = begin;
  while (cell.y <= end.y) {
    if (!is_alike(light_cells_data[cell.y * across + cell.x], low, high))
      return false;
    bool row_ends = cell.x == end.x;
    cell = row_ends ? ivec2(begin.x, cell.y + 1) : cell + ivec2(1, 0);
  }
  return true;
}

bool tiles_alike(ivec2 first, ivec2 last, vec3 low, vec3 high) {
  ivec2 tile = first;
  while (tile.y <= last.y) {
    if (!is_alike(light_range_data[tile.y * frame.tiles.x + tile.x], low, high))
      return false;
    bool row_ends = tile.x == last.x;
    tile = row_ends ? ivec2(first.x, tile.y + 1) : tile + ivec2(1, 0);
  }
  return true;
}

void main() {
  int index = int(gl_GlobalInvocationID.x);
  if (index >= frame.tiles.x * frame.tiles.y || class_of_tile(classes_data[index]) != class_scatter)
    return;
  uvec4 own = light_range_data[index];
  vec3 low, high;
  unpack_range(own, low, high);
  float d_px = uintBitsToFloat(own.w);
  int reach = uniform_reach(d_px);
  if (reach > uniform_max_reach || !is_alike(own, low, high))
    return;
  ivec2 tile = ivec2(index % frame.tiles.x, index / frame.tiles.x);
  ivec2 first = max(tile - reach, ivec2(0)), last = min(tile + reach, frame.tiles - 1);
  if (!cells_alike(first, last, low, high) && !tiles_alike(first, last, low, high))
    return;
  classes_data[index] = class_uniform | (classes_data[index] & class_full_bit);
  recount_as_uniform(d_px);
}
