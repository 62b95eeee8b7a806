// The result of subsurface.separable with 25 taps at a single pixel, without its intermediate
// image: each invocation computes the horizontal pass at one pixel of the column that the vertical
// pass reads. Reads one tap at a time, so that the code is short.
#ifndef DERMIS_SEPARABLE_AT_PIXEL_GLSL
#define DERMIS_SEPARABLE_AT_PIXEL_GLSL

#extension GL_EXT_control_flow_attributes : require

#include "common/environment.glsl"
#include "common/half.glsl"
#include "options.glsl"
#include "separable/kernel.glsl"
#include "separable/pixel_scatter.glsl"
#include "separable/surface.glsl"

// The kernel that includes this file defines both functions.
// Profile id of a pixel; 0: no subsurface, or outside the rectangle.
uint profile_at(ivec2 pixel);
// d of the widest channel in mm.
float d_at(ivec2 texel, uint profile);

// Pixels of the column, at most: the pixel itself, then its taps above and below.
const uint column_pixels = 1u + 2u * uint(max_side_taps);

// The part of the result that one invocation computes.
struct column_part {
  tap_sums sums; // the contribution of its pixel of the column
  vec3 blurred;  // light of its pixel after the horizontal pass, if that contributes
  // of the pixel itself
  scattering_pixel at;
  kernel_ends ends;
  vec3 light; // before both passes
};

// Returns the light of a pixel after the horizontal pass.
vec3 scatter_row(ivec2 pixel) {
  const separable_pass horizontal = separable_pass(false, TAPS_25, KERNEL_FITTED);
  ivec2 texel = texel_of(pixel);
  vec4 light = light_at(texel);
  uint profile = uint(light.a);
  float d = d_at(texel, profile);
  if (!scatters_at(profile, d, depth_at(texel)))
    return light.rgb;
  scattering_pixel at = find_scattering_pixel(horizontal, pixel, true, profile, d, light);
  kernel_place place = find_kernel(at.kernel, TAPS_25, at.d_px);
  kernel_ends ends = find_ends(place, at.footprint);
  tap_sums sums = tap_sums(ends.own * light.rgb, ends.own);
  [[dont_unroll]] for (int i = 2; i < 2 + 2 * ends.used; ++i) {
    kernel_tap tap = find_tap(place, i / 2, ends.core, at.footprint);
    int pixels = int(roundEven(tap.offset));
    ivec2 near = pixel + ivec2((i & 1) != 0 ? -pixels : pixels, 0);
    vec4 read = read_tap(at, texel_of(clamp(near, ivec2(0), frame.rect.zw - 1)), inside_rect(near));
    vec3 weight = tap.weight * nearness(tap, ends.core, read.a);
    sums.light += weight * read.rgb;
    sums.weight += weight;
  }
  return round_to_half(complete(horizontal, at, ends, light.rgb, light.rgb,
                                normalised(sums, light.rgb)));
}

// Returns how much deeper another pixel of the column is than `at`; infinite if it shows another
// surface or is outside the rectangle.
float rise_of(ivec2 pixel, scattering_pixel at) {
  float depth = inside_rect(pixel) ? depth_at(texel_of(pixel)) : no_surface();
  return is_surface(depth) && stored_profile(profile_at(pixel)) == at.profile ? depth - at.depth
                                                                              : no_surface();
}

// Computes one pixel of the column around a pixel that scatters: `row` < column_pixels. The sums of
// all rows, added, are those of complete_column().
column_part scatter_column(ivec2 pixel, uint row) {
  const separable_pass vertical = separable_pass(true, TAPS_25, KERNEL_FITTED);
  ivec2 texel = texel_of(pixel);
  vec4 light = light_at(texel);
  uint profile = uint(light.a);
  column_part part;
  part.sums = tap_sums(vec3(0.0), vec3(0.0));
  part.blurred = vec3(0.0);
  part.light = light.rgb;
  part.at = find_scattering_pixel(vertical, pixel, true, profile, d_at(texel, profile), light);
  kernel_place place = find_kernel(part.at.kernel, TAPS_25, part.at.d_px);
  part.ends = find_ends(place, part.at.footprint);
  int i = int(row + 1u) / 2;
  if (i > part.ends.used)
    return part;
  vec3 weight = part.ends.own;
  if (i > 0) {
    kernel_tap tap = find_tap(place, i, part.ends.core, part.at.footprint);
    int pixels = int(roundEven(tap.offset));
    pixel.y += (row & 1u) != 0u ? -pixels : pixels;
    weight = tap.weight * nearness(tap, part.ends.core, rise_of(pixel, part.at));
  }
  if (i > 0 && all(equal(weight, vec3(0.0))))
    return part; // no light of the same surface, or outside the rectangle
  part.blurred = scatter_row(pixel);
  part.sums = tap_sums(weight * part.blurred, weight);
  return part;
}

// Returns the light of the pixel after both passes. `part`: of row 0.
vec3 complete_column(column_part part, tap_sums sums) {
  const separable_pass vertical = separable_pass(true, TAPS_25, KERNEL_FITTED);
  return complete(vertical, part.at, part.ends, part.blurred, part.light,
                  normalised(sums, part.blurred));
}

#endif
