#version 460
// Estimates by how much scattering changes each tile: the square of the range of exposed light in
// the tile, plus that in the tiles that scattering reaches, times the fraction that a short d
// leaves, times the square of the host's importance. An invocation handles a tile.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "common/subsurface_tile_change.bindings.glsl"
#include "common/constants_math.glsl"
#include "common/environment.glsl"
#include "common/light_range.glsl"
#include "common/tile_packing.glsl"

layout(local_size_x = 64, local_size_y = 1, local_size_z = 1) in;

const float max_range = 4.0;            // of exposed light
const float change_steps = 4194304.0;   // 2^22: a step is a range of 2^-11
const float full_change_d_px = 4.0;     // the squared change grows with d up to here
const float tiles_per_d = 0.25;         // two d
const int max_reach = 3;                // tiles to each side
const int importance_step = 2;          // pixels between those whose importance is read

// Returns the luminance of the range of light around a tile.
float range_around(ivec2 tile, int reach) {
  vec3 low = vec3(65504.0), high = vec3(0.0);
  ivec2 first = max(tile - reach, ivec2(0)), last = min(tile + reach, frame.tiles - 1), at = first;
  while (at.y <= last.y) {
    uvec4 range = light_range_data[at.y * frame.tiles.x + at.x];
    vec3 other_low, other_high;
    unpack_range(range, other_low, other_high);
    if (range.w != 0u) { // the light of other tiles is not known
      low = min(low, other_low);
      high = max(high, other_high);
    }
    bool row_ends = at.x == last.x;
    at = row_ends ? ivec2(first.x, at.y + 1) : at + ivec2(1, 0);
  }
  return dot(max(high - low, vec3(0.0)), luminance_weights);
}

float mean_importance(ivec2 tile) {
  if (!has_importance())
    return 1.0;
  float sum = 0.0;
  ivec2 last = frame.rect.zw - 1;
  for (int i = importance_step / 2; i < 64; i += importance_step * (i % 8 < 6 ? 1 : 5)) {
    ivec2 pixel = min(8 * tile + ivec2(i & 7, i >> 3), last);
    sum += clamp(texelFetch(importance_image, texel_of(pixel), 0).r, 0.0, 1.0);
  }
  return sum / 16.0;
}

void main() {
  int index = int(gl_GlobalInvocationID.x);
  if (index >= frame.tiles.x * frame.tiles.y)
    return;
  uint change = 0u;
  if (class_of_tile(classes_data[index]) == class_scatter) {
    ivec2 tile = ivec2(index % frame.tiles.x, index / frame.tiles.x);
    float d_px = uintBitsToFloat(light_range_data[index].w);
    int reach = clamp(int(ceil(tiles_per_d * d_px)), 1, max_reach);
    vec2 ranges = vec2(range_around(tile, 0), range_around(tile, reach)) * frame.exposure;
    ranges = min(ranges, max_range) * mean_importance(tile);
    float amount = dot(ranges, ranges) * min(d_px / full_change_d_px, 1.0);
    change = uint(amount * change_steps + 0.5);
  }
  tile_changes_data[index] = change;
}
