// Projected scattering radius, which decides whether a pixel is copied.
#ifndef DERMIS_RADIUS_GLSL
#define DERMIS_RADIUS_GLSL

#include "constants.glsl"
#include "common/environment.glsl"

// Returns the factor on d from an optional per-pixel map. These values are replaced by 0 (diffuse):
// - NaN and negative values;
// - infinity, and the largest half float, which infinity may have become: a single one would widen
//   d of all pixels around;
// - factors below 1e-6: d is then far below a pixel, and tabulated profiles divide by the square of
//   the factor, which underflows to 0 below 1e-22.
float clean_scatter_scale(float value) { return value >= 1e-6 && value < 65504.0 ? value : 0.0; }

// Returns d of the widest channel in pixels.
float projected_d(float d_max_mm, float depth) {
  vec2 footprint = pixel_footprint(depth);
  return d_max_mm / max(min(footprint.x, footprint.y), 1e-20);
}

#endif
