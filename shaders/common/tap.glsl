// One sample of the surface around a pixel.
#ifndef DERMIS_TAP_GLSL
#define DERMIS_TAP_GLSL

#extension GL_EXT_samplerless_texture_functions : require

#include "common/constants_math.glsl"
#include "common/environment.glsl"
#include "common/profile.glsl"

// The pixel whose light is sampled.
struct scatter_point {
  ivec2 pixel;
  uint id;
  float depth;   // mm
  vec3 position; // view space, mm
};

// The surface under a sample.
struct surface_tap {
  vec2 at;     // the sample's place in pixels of the rectangle; integers are centres
  ivec2 pixel; // the pixel there
  float depth; // of this pixel, mm
  vec2 slope;  // of this pixel's patch, as surface_patch
};

// Finds the surface at `at`, in pixels of the rectangle. Returns false if profile `id` has no
// surface there.
bool find_tap(utexture2D material, texture2D depth, texture2D slope, uint id, vec2 at,
              out surface_tap tap) {
  tap = surface_tap(at, ivec2(round(clamp(at, vec2(-1.0), vec2(frame.rect.zw)))), 0.0, vec2(0.0));
  if (!inside_bounds(tap.pixel))
    return false;
  ivec2 texel = texel_of(tap.pixel);
  if (profile_of(texelFetch(material, texel, 0).r) != id)
    return false;
  tap.depth = view_depth(texelFetch(depth, texel, 0).r);
  tap.slope = texelFetch(slope, texel, 0).rg;
  return tap.depth > 0.0;
}

// Returns the distance of a sample, mm, at least what its radius across the view allows. Without
// this limit, an offset that rounds to none would have the infinite weight of R at 0.
float tap_distance(float distance_3d, float radius, float zoom) {
  const float min_part = 0.5; // of the radius, for rays up to 60 degrees off the axis
  return max(distance_3d, max(min_part * radius * min(zoom, 1.0), 1e-12));
}

// Returns weight_c = R_c(distance) * area / density on the plane; its mean is the fraction of the
// kernel that hits the surface. `radial`: the sample's radius across the view, with its density.
// `footprints`: of the tap's patch, as surface_patch.
vec3 tap_weight(scatter_point point, scatter_profile profile, surface_tap tap, radial_sample radial,
                float footprints) {
  // Uses the sample's own point on the patch, not the patch's centre, because the reference
  // averages over the patch.
  float depth = tap.depth + dot(tap.slope * pixel_footprint(tap.depth), tap.at - vec2(tap.pixel));
  // The density on the view plane at the pixel's depth is the density of the radius / (2 pi r).
  float zoom = is_perspective() ? tap.depth / point.depth : 1.0;
  float distance_3d =
      tap_distance(length(view_position(tap.at, depth) - point.position), radial.r, zoom);
  return profile_falloff(profile, distance_3d) *
         (radial.r / radial.density * footprints * zoom * zoom);
}

#endif
