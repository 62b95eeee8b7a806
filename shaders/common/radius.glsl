// Projected scattering radius and the decision to leave a pixel alone.
#ifndef DERMIS_RADIUS_GLSL
#define DERMIS_RADIUS_GLSL

#include "constants.glsl"
#include "common/environment.glsl"

// Factor on d from an optional per-pixel map; what is not a number or negative counts as 0 (diffuse).
float clean_scatter_scale(float value) { return value > 0.0 ? min(value, 1e6) : 0.0; }

// d of the widest channel in pixels.
float projected_d(float d_max_mm, float depth) {
  vec2 footprint = pixel_footprint(depth);
  return d_max_mm / max(min(footprint.x, footprint.y), 1e-20);
}

#endif
