// The surface patch covered by a pixel, from depth differences. Mirrors
// passes/common/reference/surface.cpp.
#ifndef DERMIS_PATCH_GLSL
#define DERMIS_PATCH_GLSL

#include "constants.glsl"
#include "common/environment.glsl"

// Depths of a pixel's neighbours along both axes, mm; 0 if the neighbour is outside, has another
// profile or no depth.
struct patch_neighbours {
  vec2 before, after; // x: along the row, y: along the column
};

// Returns the maximum difference in depth, along the row and the column, of neighbours on one
// surface, mm.
vec2 max_patch_step(float depth) { return max_patch_slope * pixel_footprint(depth); }

const float no_neighbour = 1e30; // mm, distance to a neighbour that does not exist

// Returns the tangent along an axis, towards the neighbour of the same profile that is nearer in
// depth, if their depths differ by at most `max_step` (mm). Without such a neighbour the tangent
// lies across the view.
vec3 patch_tangent(ivec2 pixel, ivec2 axis, float before, float after, float depth, float max_step,
                   vec3 position) {
  float away_before = abs(before - depth), away_after = abs(after - depth);
  away_before = before > 0.0 ? away_before : no_neighbour;
  away_after = after > 0.0 ? away_after : no_neighbour;
  bool backwards = away_before < away_after, within = min(away_before, away_after) <= max_step;
  float neighbour = backwards ? before : after;
  neighbour = within ? neighbour : depth;
  int side = backwards ? -1 : 1;
  return float(side) * (view_position(vec2(pixel + side * axis), neighbour) - position);
}

struct surface_patch {
  vec2 slope;  // d depth / d pixel, in footprints per pixel
  // Area divided by the area of the pixel's cross-section: 1 / cos of the angle to the viewer,
  // capped.
  float area;
  // Area divided by that of the pixel's footprint on the plane across the view axis. Rays of a
  // perspective view meet that plane at an angle, which makes the cross-section smaller.
  float footprints;
};

// Computes both sides of most choices and selects, because each branch in a loop multiplies the
// time that some drivers take to compile it.
surface_patch build_patch(ivec2 pixel, float depth, patch_neighbours around) {
  vec3 position = view_position(vec2(pixel), depth);
  vec3 ray = position / depth;
  ray = is_perspective() ? ray : vec3(0.0, 0.0, -1.0);
  vec3 viewer = -normalize(ray);
  vec2 max_step = max_patch_step(depth);
  vec3 normal = cross(patch_tangent(pixel, ivec2(1, 0), around.before.x, around.after.x, depth,
                                    max_step.x, position),
                      patch_tangent(pixel, ivec2(0, 1), around.before.y, around.after.y, depth,
                                    max_step.y, position));
  float size = length(normal);
  vec3 unit = normal / size;
  normal = size > 0.0 ? unit : viewer;
  normal *= dot(normal, viewer) < 0.0 ? -1.0 : 1.0;
  float cosine = dot(normal, viewer);
  // Tilts the normal towards the viewer until the cosine reaches the limit.
  if (cosine < min_patch_cosine) {
    vec3 across = normal - viewer * cosine;
    float across_size = length(across);
    vec3 tilted = across * (sqrt(1.0 - min_patch_cosine * min_patch_cosine) / across_size) +
                  viewer * min_patch_cosine;
    normal = across_size > 0.0 ? tilted : viewer;
    cosine = max(dot(normal, viewer), min_patch_cosine);
  }
  surface_patch result;
  // Derivative by pixel of the plane dot(normal, P) = const with P = depth * (scale * pixel +
  // offset, -1). For an orthographic ray, x and y do not depend on depth, which gives the same
  // quotient.
  vec2 signs = sign(frame.ray_scale);
  float along_view = is_perspective() ? -dot(normal, ray) : normal.z;
  result.slope = normal.xy * signs / along_view;
  result.area = 1.0 / cosine;
  result.footprints = result.area / length(ray);
  return result;
}

#endif
