#pragma once
// A profile integrated over one pixel's patch: the contribution of a pixel's constant light to a
// point.

#include "passes/common/profiles/shape.hpp"
#include "passes/common/reference/surface.hpp"

#include <array>
#include <cstdint>

namespace dermis::subsurface {

using PerChannel = std::array<double, 3>; // red, green, blue

// Patches within this distance (in pixels, on both axes) are integrated with sub_points^2 points,
// others with their centre.
inline constexpr int near_pixels = 4;
inline constexpr int sub_points = 8;
// Pixels count if their nearest part is within shape_reach of the channel with the largest reach:
// this many d for Burley.
inline constexpr double reference_radius_in_d = 20;

// Returns Burley's profile in all channels, for each d.
ProfileShape burley_shapes(const PerChannel& d);
// Returns the largest shape_reach of the channels.
double reach_of(const ProfileShape& shape);

// Returns the mean over the patch of pixel (x, y) of R_c(distance to `point`), 1/m^2, for shapes in
// metres (d = 0 gives 0). Must not be used for the patch that contains `point`.
PerChannel patch_mean(const PixelRays& rays, const Patch& patch, double x, double y, bool near,
                      const Vector3& point, const ProfileShape& shape);

// Returns the integral of R_c over the patch whose centre is the point. The 1/r singularity
// vanishes in polar coordinates: each edge of the patch spans a triangle whose integral is that of
// cdf(rho(theta)) / 2 pi. Dimensionless, in (0, 1]; 1 for d = 0.
PerChannel centre_integral(const PixelRays& rays, const Patch& patch, double x, double y,
                           const ProfileShape& shape);

} // namespace dermis::subsurface
