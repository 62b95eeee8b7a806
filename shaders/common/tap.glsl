// One sample of the surface around a pixel. Include after bindings with `light`, `slope`,
// `material`, `depth`.
#ifndef DERMIS_TAP_GLSL
#define DERMIS_TAP_GLSL

#include "common/constants_math.glsl"
#include "common/environment.glsl"
#include "common/profile.glsl"


struct scatter_point {
  ivec2 pixel;
  uint id;
  float depth;   // mm
  vec3 position; // view space, mm
};

// Evaluates the sample at `at` (pixels of the rectangle, integers are centres), which was drawn at
// radius r across the view with a density of the radius. weight_c = R_c(distance) * area / density
// on the plane; its mean is the fraction of the kernel that hits the surface. light: rgb, a = area.
// Returns false if the pixel's profile has no surface there.
bool take_tap(scatter_point point, scatter_profile profile, vec2 at, radial_sample drawn, out vec3 weight, out vec4 light) {
  weight = vec3(0.0);
  light = vec4(0.0);
  ivec2 q = ivec2(round(clamp(at, vec2(-1.0), vec2(frame.rect.zw))));
  if (!inside_rect(q))
    return false;
  ivec2 texel = texel_of(q);
  if (texelFetch(material_image, texel, 0).r != point.id)
    return false;
  float depth = view_depth(texelFetch(depth_image, texel, 0).r);
  if (depth <= 0.0)
    return false;
  light = texelFetch(light_image, texel, 0);
  vec2 slope = texelFetch(slope_image, texel, 0).rg;
  // Uses the sample's own point on the patch, not the patch's centre, because the reference
  // averages over the patch.
  float point_depth = depth + dot(slope * pixel_footprint(depth), at - vec2(q));
  float distance_3d = max(length(view_position(at, point_depth) - point.position), 1e-12);
  // The density on the view plane at the pixel's depth is the density of the radius / (2 pi r).
  float zoom = is_perspective() ? depth / point.depth : 1.0;
  weight = profile_falloff(profile, distance_3d) * (drawn.r / drawn.density * light.a * zoom * zoom);
  return true;
}

#endif
