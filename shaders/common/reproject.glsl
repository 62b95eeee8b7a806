// Reprojection into the previous frame: finds the position of a pixel's surface, and which of the
// four texels around it show the same surface. passes/common/reproject.hpp mirrors these functions
// under the same names; find_history there is taps_around, shows_surface and normalised_taps here.
#ifndef DERMIS_REPROJECT_GLSL
#define DERMIS_REPROJECT_GLSL

#include "constants.glsl"
#include "common/environment.glsl"

bool history_usable() { return (frame.flags & 4u) == 0u; }
bool previous_is_perspective() { return (frame.flags & 8u) != 0u; }

struct previous_position {
  vec2 pixel;  // position in the previous rectangle; integers are centres
  float depth; // depth of the surface in the previous view, mm; 0: none
};

// Returns the position in the previous frame of a point that is static in the world. `pixel`: now,
// integers are centres. `depth`: view depth now, mm.
previous_position reproject(vec2 pixel, float depth) {
  vec4 at = vec4(view_position(pixel, depth), 1.0);
  vec3 before = vec3(dot(frame.previous_from_view[0], at), dot(frame.previous_from_view[1], at),
                     dot(frame.previous_from_view[2], at));
  float k = previous_is_perspective() ? -before.z : 1.0;
  if (!(before.z < 0.0))
    return previous_position(vec2(0.0), 0.0);
  vec2 place = (before.xy / k - frame.previous_ray_offset) / frame.previous_ray_scale;
  // A static camera must not blur: steps below 0.001 pixel are rounding errors.
  vec2 whole = round(place);
  return previous_position(mix(place, whole, lessThan(abs(place - whole), vec2(reproject_snap_px))),
                           -before.z);
}

// Returns the position in the previous frame of a point with a velocity. xy: movement since the
// previous frame, including that of the camera, in pixels of this frame's rectangle without jitter.
// z: change of the view depth by the movement of the point only, without the camera, world units.
previous_position reproject(vec2 pixel, float depth, vec3 velocity) {
  previous_position by_camera = reproject(pixel, depth);
  if (!all(lessThan(abs(velocity), vec3(reproject_largest_velocity)))) // NaN compares false
    return previous_position(vec2(0.0), 0.0);
  vec2 unjittered = (pixel - frame.jitter - velocity.xy + 0.5) * vec2(frame.previous_rect.zw) /
                        vec2(frame.rect.zw) -
                    0.5;
  vec2 place = unjittered + frame.previous_jitter, whole = round(place);
  return previous_position(mix(place, whole, lessThan(abs(place - whole), vec2(reproject_snap_px))),
                           by_camera.depth > 0.0
                               ? max(by_camera.depth - velocity.z * frame.depth_unit, 0.0)
                               : 0.0);
}

bool inside_previous(ivec2 pixel) {
  return all(greaterThanEqual(pixel, ivec2(0))) && all(lessThan(pixel, frame.previous_rect.zw));
}
ivec2 previous_texel(ivec2 pixel) { return pixel + frame.previous_rect.xy; }

// Returns the distance in depth up to which two places are on one surface, mm. `depth`: in the
// previous view, mm. `rise`: change of the surface's depth over a pixel, mm.
float depth_tolerance(float depth, float rise) {
  vec2 pixel = abs(frame.previous_ray_scale);
  float least = previous_is_perspective() ? reproject_depth_fraction * depth
                                          : reproject_depth_pixels * max(pixel.x, pixel.y) +
                                                reproject_depth_rounding * depth;
  return max(least, reproject_slope_pixels * rise);
}

struct history_taps {
  ivec2 first;  // the weights belong to first, first + (1, 0), first + (0, 1), first + (1, 1)
  vec4 weight;  // sum 1; all 0 if the surface was not visible
};

// Returns the pixel of tap i in the previous rectangle.
ivec2 tap_pixel(history_taps taps, int i) { return taps.first + ivec2(i & 1, i >> 1); }

// Returns bilinear weights of the taps in the previous rectangle. A kernel clears the weights of
// taps that do not show the surface (shows_surface) and calls normalised_taps.
history_taps taps_around(previous_position place) {
  history_taps none = history_taps(ivec2(0), vec4(0.0));
  if (!(place.depth > 0.0) || !all(lessThan(abs(place.pixel), vec2(reproject_largest_velocity))))
    return none;
  ivec2 first = ivec2(floor(place.pixel));
  vec2 part = place.pixel - vec2(first);
  history_taps taps =
      history_taps(first, vec4((1.0 - part.x) * (1.0 - part.y), part.x * (1.0 - part.y),
                               (1.0 - part.x) * part.y, part.x * part.y));
  for (int i = 0; i < 4; ++i)
    if (!inside_previous(tap_pixel(taps, i)))
      taps.weight[i] = 0.0;
  return taps;
}

// Returns whether `surface` of the previous frame (x: view depth in mm, y: profile id; 0, 0: no
// surface) has profile `id` and is within `tolerance` (mm) of the expected depth.
bool shows_surface(vec2 surface, previous_position place, uint id, float tolerance) {
  return uint(surface.y) == id && abs(surface.x - place.depth) <= tolerance;
}

// Returns the taps with weights of sum 1, or all 0 if too little of the surface was visible.
history_taps normalised_taps(history_taps taps) {
  float total = taps.weight.x + taps.weight.y + taps.weight.z + taps.weight.w;
  return total < reproject_min_weight ? history_taps(ivec2(0), vec4(0.0))
                                      : history_taps(taps.first, taps.weight / total);
}

#endif
