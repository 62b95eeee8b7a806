#version 460
// Evaluates the functions of tile_edges.glsl for every pixel of 5x4 tiles, one arrangement of tiles
// below the other: edge_weight for ramps of 4 and 8 pixels, and has_samples of the pixel's tile and
// of the tile two up and two to the left. A row of the table of questions holds a tile's class and
// its samples.
#extension GL_GOOGLE_include_directive : require
#include "common/environment.glsl"
#include "common/tile_edges.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 0, rgba32f) uniform writeonly image2D target;
layout(push_constant) uniform push_block { uint port_mask; };

const int tile_count = 20;

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, imageSize(target))))
    return;
  int rows = 8 * frame.tiles.y, arrangement = pixel.y / rows;
  bool known[tile_count];
  for (int i = 0; i < tile_count; ++i) {
    vec4 tile = separable_rows[arrangement * tile_count + i];
    known[i] = has_samples(uint(tile.x), uint(tile.y));
  }
  ivec2 at = ivec2(pixel.x, pixel.y % rows), tile = at >> 3;
  uint sampled = 0u;
  for (int i = 0; i < edge_tiles; ++i)
    sampled |= known[edge_tile(tile, i)] ? 1u << uint(i) : 0u;
  imageStore(target, pixel,
             vec4(edge_weight(sampled, at, 4.0), edge_weight(sampled, at, 8.0),
                  float(known[edge_tile(tile, 4)]), float(known[edge_tile(tile - 1, 0)])));
}
