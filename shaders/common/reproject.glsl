// Looking back one frame: where the surface of a pixel stood, and which of the four texels around that place show the
// same surface. passes/common/reproject.hpp mirrors these functions under the same names. Include after
// `vec2 surface_before(ivec2 pixel)`: view depth in mm and profile id that the frame before had at a pixel of its
// rectangle; 0, 0 where it had none.
#ifndef DERMIS_REPROJECT_GLSL
#define DERMIS_REPROJECT_GLSL

#include "constants.glsl"
#include "common/environment.glsl"

bool history_usable() { return (frame.flags & 4u) == 0u; }

struct previous_place {
  vec2 pixel;  // of the rectangle then, integers are centres
  float depth; // that the surface had in that view, mm; 0: no place to look at
};

// Of a point that stands still in the world.
previous_place place_before(vec2 pixel, float depth) {
  vec4 at = vec4(view_position(pixel, depth), 1.0);
  vec3 before = vec3(dot(frame.previous_from_view[0], at), dot(frame.previous_from_view[1], at),
                     dot(frame.previous_from_view[2], at));
  float k = (frame.flags & 8u) != 0u ? -before.z : 1.0;
  if (!(before.z < 0.0))
    return previous_place(vec2(0.0), 0.0);
  vec2 place = (before.xy / k - frame.previous_ray_offset) / frame.previous_ray_scale;
  vec2 whole = round(place); // a camera that rests must not blur: steps below a thousandth of a pixel are rounding
  return previous_place(mix(place, whole, lessThan(abs(place - whole), vec2(reproject_snap_px))), -before.z);
}

// Of a point with a velocity: xy = now - before, pixels of this frame's rectangle, jitter taken out; z = view depth now -
// before that the camera does not explain, world units.
previous_place place_before(vec2 pixel, float depth, vec3 velocity) {
  previous_place still = place_before(pixel, depth);
  if (!all(lessThan(abs(velocity), vec3(reproject_largest_velocity)))) // NaN compares false
    return previous_place(vec2(0.0), 0.0);
  vec2 steady = (pixel - frame.jitter - velocity.xy + 0.5) * vec2(frame.previous_rect.zw) / vec2(frame.rect.zw) - 0.5;
  vec2 place = steady + frame.previous_jitter, whole = round(place);
  return previous_place(mix(place, whole, lessThan(abs(place - whole), vec2(reproject_snap_px))),
                        still.depth > 0.0 ? max(still.depth - velocity.z * frame.depth_unit, 0.0) : 0.0);
}

bool inside_previous(ivec2 pixel) {
  return all(greaterThanEqual(pixel, ivec2(0))) && all(lessThan(pixel, frame.previous_rect.zw));
}
ivec2 previous_texel(ivec2 pixel) { return pixel + frame.previous_rect.xy; }

// Distance in depth up to which two places are one surface. `rise`: change of its depth over a pixel, mm.
float depth_tolerance(float depth, float rise) {
  return max(reproject_depth_fraction * depth, reproject_slope_pixels * rise);
}

struct history_taps {
  ivec2 first;  // weights are of first, first + (1, 0), first + (0, 1), first + (1, 1)
  vec4 weight;  // sum 1; all 0 where the surface was not to be seen
};

// Bilinear weights of those taps that show profile `id` within `tolerance` (mm) of the expected depth.
history_taps find_history(previous_place place, uint id, float tolerance) {
  history_taps none = history_taps(ivec2(0), vec4(0.0));
  if (!(place.depth > 0.0) || !all(lessThan(abs(place.pixel), vec2(reproject_largest_velocity))))
    return none;
  ivec2 first = ivec2(floor(place.pixel));
  vec2 part = place.pixel - vec2(first);
  vec4 weight = vec4((1.0 - part.x) * (1.0 - part.y), part.x * (1.0 - part.y), (1.0 - part.x) * part.y, part.x * part.y);
  for (int i = 0; i < 4; ++i) {
    ivec2 pixel = first + ivec2(i & 1, i >> 1);
    if (weight[i] > 0.0 && inside_previous(pixel)) {
      vec2 surface = surface_before(pixel);
      if (uint(surface.y) == id && abs(surface.x - place.depth) <= tolerance)
        continue;
    }
    weight[i] = 0.0;
  }
  float total = weight.x + weight.y + weight.z + weight.w;
  return total < reproject_min_weight ? none : history_taps(first, weight / total);
}

#endif
