#version 460
// Estimates the change of luminance of the whole picture since the ratios were learned, as a
// logarithm, and its tolerance. The change is the most common change of surfaces, each compared
// with itself, for any motion of the camera.
// Also estimates how many more surfaces agree with this change than would by chance. If light comes
// from another direction, none do, although some surfaces may become as bright as before. One group
// reads a pixel of each tile, or of some tiles.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "papers/subsurface_global_light_change.bindings.glsl"
#include "common/environment.glsl"
#include "common/hash.glsl"
#include "common/tile_packing.glsl"
#include "sap/sap.glsl"
#include "common/reproject.glsl"
#include "papers/residual.glsl"

layout(local_size_x = 64, local_size_y = 1, local_size_z = 1) in;

const uint lanes = 64u;
const uint each = 16u;           // maximum number of pixels per lane
// Width in logarithms: a deviation of this size from the most common change halves the weight.
const float width = 0.25;
const int turns = 8;             // iterations towards the most common change
const int halvings = 10;         // bisections of the interval that holds the median
const float per_median = 3.0;    // tolerance in median deviations: 95 % of a normal distribution
// Maximum tolerance of a logarithm, by measurement: beyond it, light from another direction looks
// unchanged.
const float max_tolerance = 0.12;
// Minimum fraction of the agreeing surfaces that is assumed to agree by chance.
const float min_chance = 0.01;

shared float offsets[lanes * each]; // logarithms
shared float squared_deviations[lanes * each];  // squared deviations in stable light
shared vec2 sums[lanes];

// Computes the logarithm of luminance of the surface at a pixel relative to the pattern that it
// learned, and the squared deviation of its patterns. Returns false if the surface was not visible
// before, or is dark.
bool offset_of(ivec2 pixel, out float offset, out float squared_deviation) {
  offset = 0.0;
  squared_deviation = 0.0;
  if (!inside_rect(pixel) || class_of_tile(classes_data[sap_tile(pixel)]) != class_scatter)
    return false;
  ivec2 texel = texel_of(pixel);
  sap_texel own = sap_unpack(texelFetch(surface_image, texel, 0));
  vec3 light = texelFetch(scattered_image, texel, 0).rgb;
  if (own.id == 0u || !is_lit(light))
    return false;
  previous_position place = has_velocity() ? reproject(vec2(pixel), own.depth,
                                                       texelFetch(velocity_image, texel, 0).rgb)
                                        : reproject(vec2(pixel), own.depth);
  float tolerance = depth_tolerance(place.depth, length(own.slope) * sap_footprint(own.depth));
  history_taps taps = find_history(place_image, place, own.id, tolerance);
  vec2 kept = pattern_before(place_image, taps);
  offset = log_luminance(light) - kept.x;
  squared_deviation = kept.y;
  return has_pattern(kept);
}

// Returns the sum over the group.
vec2 summed(vec2 own) {
  barrier();
  sums[gl_LocalInvocationIndex] = own;
  barrier();
  vec2 sum = vec2(0.0);
  for (uint i = 0u; i < lanes; ++i)
    sum += sums[i];
  return sum;
}

// Returns the most common change: the mean first, then iterations with weights that fall with the
// distance from the result.
float most_common(uint lane, uint known) {
  float found = 0.0;
  for (int turn = 0; turn < turns; ++turn) {
    vec2 sum = vec2(0.0);
    for (uint k = 0u; k < each; ++k) {
      uint i = k * lanes + lane;
      float off = (offsets[i] - found) / width;
      float weight = turn == 0 ? 1.0 : 1.0 / (1.0 + off * off);
      if ((known >> k & 1u) != 0u)
        sum += weight * vec2(offsets[i], 1.0);
    }
    sum = summed(sum);
    found = sum.y > 0.0 ? sum.x / sum.y : 0.0;
  }
  return found;
}

// Returns the median deviation from `found`, at most max_tolerance.
float median_deviation(uint lane, uint known, float found) {
  float below = 0.0, above = max_tolerance;
  for (int halving = 0; halving < halvings; ++halving) {
    float middle = 0.5 * (below + above);
    vec2 sum = vec2(0.0);
    for (uint k = 0u; k < each; ++k) {
      uint i = k * lanes + lane;
      if ((known >> k & 1u) != 0u)
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

// Returns the odds that the light of a surface with the common change is unchanged, rather than in
// agreement by chance. The density of agreement by chance is that in the ring from two to four
// tolerances.
float odds_of_agreement(uint lane, uint known, float found, float tolerance) {
  vec2 sum = vec2(0.0);
  for (uint k = 0u; k < each; ++k) {
    uint i = k * lanes + lane;
    float off = abs(offsets[i] - found) / tolerance_of(tolerance, squared_deviations[i]);
    if ((known >> k & 1u) != 0u)
      sum += vec2(off < 2.0 ? 1.0 : 0.0, off >= 2.0 && off < 4.0 ? 1.0 : 0.0);
  }
  sum = summed(sum);
  float agree = max(sum.x - sum.y, 0.0) / sqrt_pi; // height of exp(-x^2) in tolerances
  float chance = sum.y / 4.0 + min_chance * agree;
  return agree > 0.0 ? agree / chance : 0.0;
}

void main() {
  uint lane = gl_LocalInvocationIndex, tiles = uint(frame.tiles.x * frame.tiles.y);
  uint stride = max((tiles + lanes * each - 1u) / (lanes * each), 1u);
  uint known = 0u; // bit k: pixel k of the lane has an offset
  for (uint k = 0u; k < each; ++k) {
    // A random tile of each stride: a width that divides the stride would select one column.
    uint i = k * lanes + lane, tile = i * stride + pcg3d(uvec3(i, 0u, 0u)).x % stride;
    ivec2 pixel = ivec2(tile % uint(frame.tiles.x), tile / uint(frame.tiles.x)) * 8 + 3;
    float offset = 0.0, squared_deviation = 0.0;
    if (history_usable() && tile < tiles && offset_of(pixel, offset, squared_deviation))
      known |= 1u << k;
    offsets[i] = offset;
    squared_deviations[i] = squared_deviation;
  }
  float found = most_common(lane, known);
  float median = median_deviation(lane, known, found);
  float tolerance = max(settings.tolerance, min(per_median * median, max_tolerance));
  float odds = odds_of_agreement(lane, known, found, tolerance);
  if (lane == 0u)
    imageStore(luminance_change_image, ivec2(0), vec4(found, odds, tolerance, 0.0));
}
