#version 460
// Evaluates the functions of reproject.glsl for case x, one row per question:
//   row 0  reproject of a static point: pixel, depth; history_usable
//   row 1  reproject of a point with a velocity: pixel, depth; depth_tolerance
//   row 2  the taps that show the surface: the first texel, the number of valid taps
//   row 3  the taps that show the surface: the weights
// A case is three rows of the table of questions, followed by depth and profile of the texels of
// the previous frame; see reproject_test.cpp in this folder.
#extension GL_GOOGLE_include_directive : require
#include "common/environment.glsl"
#include "common/reproject.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 0, rgba32f) uniform writeonly image2D target;
layout(push_constant) uniform push_block { uint port_mask; };

const int rows_of_case = 3, texels_across = 16;

vec2 surface_before(ivec2 pixel) {
  ivec2 texel = previous_texel(pixel);
  return separable_rows[rows_of_case * imageSize(target).x + texels_across * texel.y + texel.x].xy;
}

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(at, imageSize(target))))
    return;
  vec4 seen = separable_rows[rows_of_case * at.x]; // pixel, depth, rise
  vec4 moved = separable_rows[rows_of_case * at.x + 1]; // velocity, profile
  vec4 requested = separable_rows[rows_of_case * at.x + 2]; // place, depth, tolerance
  previous_position expected = previous_position(requested.xy, requested.z);
  history_taps taps = taps_around(expected);
  for (int i = 0; i < 4; ++i)
    if (taps.weight[i] > 0.0 &&
        !shows_surface(surface_before(tap_pixel(taps, i)), expected, uint(moved.w), requested.w))
      taps.weight[i] = 0.0;
  taps = normalised_taps(taps);
  vec4 answer = taps.weight;
  if (at.y == 0) {
    previous_position place = reproject(seen.xy, seen.z);
    answer = vec4(place.pixel, place.depth, float(history_usable()));
  }
  if (at.y == 1) {
    previous_position place = reproject(seen.xy, seen.z, moved.xyz);
    answer = vec4(place.pixel, place.depth, depth_tolerance(seen.z, seen.w));
  }
  if (at.y == 2)
    answer = vec4(vec2(taps.first), dot(vec4(greaterThan(taps.weight, vec4(0.0))), vec4(1.0)), 0.0);
  imageStore(target, at, answer);
}
