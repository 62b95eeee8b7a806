#pragma once
// A profile integrated over one pixel's patch: what a pixel's constant light contributes to a point.

#include "passes/common/profiles/shape.hpp"
#include "passes/common/reference/surface.hpp"

#include <array>
#include <cstdint>

namespace dermis::subsurface {

using PerChannel = std::array<double, 3>; // red, green, blue

// Patches this near (in pixels, on both axes) are integrated with sub_points^2 points, others by their
// centre.
inline constexpr int near_pixels = 4;
inline constexpr int sub_points = 8;
// Pixels count as long as their nearest part is within shape_reach of the channel that reaches farthest: this
// many d for Burley.
inline constexpr double reference_radius_in_d = 20;

// Burley's profile in all channels, for each d.
ProfileShape burley_shapes(const PerChannel& d);
// The farthest of the channels' shape_reach.
double reach_of(const ProfileShape& shape);

// Mean over the patch of pixel (x, y) of R_c(distance to `point`), 1/m^2, for shapes in metres (d = 0 gives
// 0). Not for the patch that `point` lies on.
PerChannel patch_mean(const PixelRays& rays, const Patch& patch, double x, double y, bool near,
                      const Vector3& point, const ProfileShape& shape);

// Integral of R_c over the patch that the point lies in the middle of; the 1/r singularity vanishes in polar
// coordinates: each of the patch's edges spans a triangle whose integral is that of cdf(rho(theta)) / 2 pi.
// Dimensionless, in (0, 1]; 1 for d = 0.
PerChannel centre_integral(const PixelRays& rays, const Patch& patch, double x, double y,
                           const ProfileShape& shape);

} // namespace dermis::subsurface
