// How the light of tiles that were given samples passes over into that of tiles that were not: no seams. Include after
// bindings with `classes` and `shares`.
#ifndef DERMIS_TILE_EDGES_GLSL
#define DERMIS_TILE_EDGES_GLSL

#include "common/tile_packing.glsl"

bool has_samples(ivec2 tile) {
  ivec2 at = clamp(tile, ivec2(0), frame.tiles - 1);
  uint index = uint(at.y * frame.tiles.x + at.x);
  return samples_per_tile_data[index] > 0u || class_of_tile(classes_data[index]) != class_scatter; // nothing that blends borders there
}

// 0 at an edge or a corner that a tile without samples shares, 1 from `ramp_px` inside.
float edge_weight(ivec2 pixel, float ramp_px) {
  ivec2 tile = pixel >> 3;
  vec2 from = vec2(pixel & 7) + 0.5; // from the left and upper edge
  float weight = 1.0;
  for (int y = -1; y <= 1; ++y)
    for (int x = -1; x <= 1; ++x) {
      if ((x == 0 && y == 0) || has_samples(tile + ivec2(x, y)))
        continue;
      vec2 distance = vec2(x < 0 ? from.x : 8.0 - from.x, y < 0 ? from.y : 8.0 - from.y);
      float from_edge = x == 0 ? distance.y : y == 0 ? distance.x : max(distance.x, distance.y);
      weight = min(weight, smoothstep(0.0, 1.0, from_edge / ramp_px));
    }
  return weight;
}

#endif
