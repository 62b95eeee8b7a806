// Blends the light of tiles with samples into that of tiles without samples, so that no seams
// appear. Include after bindings with `classes` and `samples_per_tile`.
#ifndef DERMIS_TILE_EDGES_GLSL
#define DERMIS_TILE_EDGES_GLSL

#include "common/tile_packing.glsl"

bool has_samples(ivec2 tile) {
  ivec2 at = clamp(tile, ivec2(0), frame.tiles - 1);
  uint index = uint(at.y * frame.tiles.x + at.x);
  // A tile that does not scatter has no blended light at the border.
  return samples_per_tile_data[index] > 0u || class_of_tile(classes_data[index]) != class_scatter;
}

// Returns 0 at an edge or corner shared with a tile without samples, and 1 from `ramp_px` pixels
// inside.
float edge_weight(ivec2 pixel, float ramp_px) {
  ivec2 tile = pixel >> 3;
  vec2 from = vec2(pixel & 7) + 0.5; // distance from the left and upper edge, pixels
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
