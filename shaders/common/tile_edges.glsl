// Blends the light of tiles with samples into that of tiles without samples, so that no seams
// appear.
#ifndef DERMIS_TILE_EDGES_GLSL
#define DERMIS_TILE_EDGES_GLSL

#include "common/environment.glsl"
#include "common/tile_packing.glsl"

const int edge_tiles = 9; // a tile and the tiles around, row by row
// Ramp of light that is replaced: the whole tile, because replaced light differs by more than
// blended light.
const float replaced_ramp_px = 8.0;

// Returns the index of tile i of the 3x3 tiles around `tile` in buffers with one element per tile.
// Beyond the picture, the tile at the edge counts.
int edge_tile(ivec2 tile, int i) {
  ivec2 at = clamp(tile + ivec2(i % 3, i / 3) - 1, ivec2(0), frame.tiles - 1);
  return at.y * frame.tiles.x + at.x;
}

// `entry`: the tile's entry in `classes`. A tile that does not scatter has no blended light at the
// border.
bool has_samples(uint entry, uint samples) {
  return samples > 0u || class_of_tile(entry) != class_scatter;
}

// Returns 0 at an edge or corner shared with a tile without samples, and 1 from `ramp_px` pixels
// inside. Bit i of `sampled`: has_samples of tile i of the 3x3 tiles around the pixel's tile.
float edge_weight(uint sampled, ivec2 pixel, float ramp_px) {
  vec2 from = vec2(pixel & 7) + 0.5; // distance from the left and upper edge, pixels
  float weight = 1.0;
  for (int y = -1; y <= 1; ++y)
    for (int x = -1; x <= 1; ++x) {
      if ((x == 0 && y == 0) || (sampled >> uint(3 * y + x + 4) & 1u) != 0u)
        continue;
      vec2 distance = vec2(x < 0 ? from.x : 8.0 - from.x, y < 0 ? from.y : 8.0 - from.y);
      float from_edge = x == 0 ? distance.y : y == 0 ? distance.x : max(distance.x, distance.y);
      weight = min(weight, smoothstep(0.0, 1.0, from_edge / ramp_px));
    }
  return weight;
}

#endif
