#version 460
// How much brighter all that is seen is than the light that ratios were learned in, as a logarithm, and how far that can be
// said: what most surfaces did, each compared with itself, wherever the camera went; and how many more of them agree with
// it than would by chance. Where a picture is lit from another side none do, though some surfaces became as bright as
// before. One group; a pixel of each tile, or of some.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "papers/subsurface_global_light_change.bindings.glsl"
#include "common/environment.glsl"
#include "common/tile_packing.glsl"
#include "sap/sap.glsl"
vec2 surface_before(ivec2 pixel);
#include "common/reproject.glsl"
#include "papers/residual.glsl"

layout(local_size_x = 64, local_size_y = 1, local_size_z = 1) in;

const uint lanes = 64u;
const uint each = 16u;           // pixels that a lane looks at, at most
const float width = 0.25;        // of a logarithm: what changed more than most by as much counts half
const int turns = 8;             // towards what most did
const int halvings = 10;         // of the interval that holds the median
const float per_median = 3.0;    // tolerance in median deviations: a normal distribution has 95 % within
const float max_tolerance = 0.12; // of a logarithm: measured, light from another side passes for the same beyond it
const float min_chance = 0.01; // of surfaces that agree, which are taken to do so by chance

shared float offsets[lanes * each]; // logarithms
shared float strays[lanes * each];  // their squares, as they are in light that stays
shared bool known[lanes * each];
shared vec2 sums[lanes];

vec2 surface_before(ivec2 pixel) { return residual_surface_before(texelFetch(place_image, previous_texel(pixel), 0)); }

// Of the surface at a pixel: its brightness beside the pattern that it learned, and how far patterns stray there. False where
// it was not to be seen before, or is dark.
bool offset_of(ivec2 pixel, out float offset, out float stray) {
  offset = 0.0;
  stray = 0.0;
  if (!inside_rect(pixel) || class_of_tile(classes_data[sap_tile(pixel)]) != class_scatter)
    return false;
  ivec2 texel = texel_of(pixel);
  sap_texel own = sap_unpack(texelFetch(surface_image, texel, 0));
  vec3 light = texelFetch(scattered_image, texel, 0).rgb;
  if (own.id == 0u || !is_lit(light))
    return false;
  previous_place place = has_velocity()
                             ? place_before(vec2(pixel), own.depth, texelFetch(velocity_image, texel, 0).rgb)
                             : place_before(vec2(pixel), own.depth);
  history_taps taps =
      find_history(place, own.id, depth_tolerance(place.depth, length(own.slope) * sap_footprint(own.depth)));
  vec2 kept = pattern_before(taps);
  offset = brightness(light) - kept.x;
  stray = kept.y;
  return has_pattern(kept);
}

// Sum over the group.
vec2 summed(vec2 own) {
  barrier();
  sums[gl_LocalInvocationIndex] = own;
  barrier();
  vec2 sum = vec2(0.0);
  for (uint i = 0u; i < lanes; ++i)
    sum += sums[i];
  return sum;
}

// What most did: the mean, then again and again with weights that fall with the distance from it.
float most_common(uint lane) {
  float found = 0.0;
  for (int turn = 0; turn < turns; ++turn) {
    vec2 sum = vec2(0.0);
    for (uint k = 0u; k < each; ++k) {
      uint i = k * lanes + lane;
      float off = (offsets[i] - found) / width;
      float weight = turn == 0 ? 1.0 : 1.0 / (1.0 + off * off);
      if (known[i])
        sum += weight * vec2(offsets[i], 1.0);
    }
    sum = summed(sum);
    found = sum.y > 0.0 ? sum.x / sum.y : 0.0;
  }
  return found;
}

// Deviation from `found` that half of them stay below; max_tolerance where it is more.
float median_deviation(uint lane, float found) {
  float below = 0.0, above = max_tolerance;
  for (int halving = 0; halving < halvings; ++halving) {
    float middle = 0.5 * (below + above);
    vec2 sum = vec2(0.0);
    for (uint k = 0u; k < each; ++k) {
      uint i = k * lanes + lane;
      if (known[i])
        sum += vec2(abs(offsets[i] - found) < middle ? 1.0 : 0.0, 1.0);
    }
    sum = summed(sum);
    if (sum.x < 0.5 * sum.y)
      below = middle;
    else
      above = middle;
  }
  return above;
}

// Of a surface that is as bright as most: how much likelier it is that its light stayed what it was than that it agrees by
// chance. What agrees by chance is as dense as what lies beside it: in the ring from two to four tolerances.
float odds_of_agreement(uint lane, float found, float tolerance) {
  vec2 sum = vec2(0.0);
  for (uint k = 0u; k < each; ++k) {
    uint i = k * lanes + lane;
    float off = abs(offsets[i] - found) / tolerance_of(tolerance, strays[i]);
    if (known[i])
      sum += vec2(off < 2.0 ? 1.0 : 0.0, off >= 2.0 && off < 4.0 ? 1.0 : 0.0);
  }
  sum = summed(sum);
  float agree = max(sum.x - sum.y, 0.0) / sqrt_pi; // exp(-x^2) in tolerances has this height
  float chance = sum.y / 4.0 + min_chance * agree;
  return agree > 0.0 ? agree / chance : 0.0;
}

void main() {
  uint lane = gl_LocalInvocationIndex, tiles = uint(frame.tiles.x * frame.tiles.y);
  uint stride = max((tiles + lanes * each - 1u) / (lanes * each), 1u);
  for (uint k = 0u; k < each; ++k) {
    uint i = k * lanes + lane, tile = i * stride;
    ivec2 pixel = ivec2(tile % uint(frame.tiles.x), tile / uint(frame.tiles.x)) * 8 + 3;
    float offset = 0.0, stray = 0.0;
    known[i] = history_usable() && tile < tiles && offset_of(pixel, offset, stray);
    offsets[i] = offset;
    strays[i] = stray;
  }
  float found = most_common(lane);
  float tolerance = max(settings.tolerance, min(per_median * median_deviation(lane, found), max_tolerance));
  float odds = odds_of_agreement(lane, found, tolerance);
  if (lane == 0u)
    imageStore(brightness_image, ivec2(0), vec4(found, odds, tolerance, 0.0));
}
