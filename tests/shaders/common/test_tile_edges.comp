#version 460
// Evaluates the functions of tile_edges.glsl for every pixel of 5x4 tiles, one arrangement of tiles
// below the other: edge_weight for ramps of 4 and 8 pixels, and has_samples of the pixel's tile and
// of the tile two up and two to the left. A row of the table of questions holds a tile's class and
// its samples.
#extension GL_GOOGLE_include_directive : require
#include "common/environment.glsl"
const int tile_count = 20;
uint classes_data[tile_count], samples_per_tile_data[tile_count];
#include "common/tile_edges.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 0, rgba32f) uniform writeonly image2D target;
layout(push_constant) uniform push_block { uint port_mask; };

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, imageSize(target))))
    return;
  int rows = 8 * frame.tiles.y, arrangement = pixel.y / rows;
  for (int i = 0; i < tile_count; ++i) {
    vec4 tile = separable_rows[arrangement * tile_count + i];
    classes_data[i] = uint(tile.x);
    samples_per_tile_data[i] = uint(tile.y);
  }
  ivec2 at = ivec2(pixel.x, pixel.y % rows);
  imageStore(target, pixel, vec4(edge_weight(at, 4.0), edge_weight(at, 8.0), float(has_samples(at >> 3)),
                                 float(has_samples((at >> 3) - 2))));
}
