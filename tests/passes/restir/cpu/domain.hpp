#pragma once
// The part of a path camera - x1 - x2 - light that the pixel fixes: its first hit x1 and how light
// scatters to x1. shaders/restir/domain.glsl mirrors these functions under the same names. Pure;
// thread: any.

#include "tests/passes/restir/cpu/vector.hpp"

#include <array>
#include <cstdint>

namespace dermis::restir {

// All lengths share one unit, chosen by the caller.
struct Domain {
  Vector3 position{}; // x1
  Vector3 normal{};   // Unit length; the first axis of the pixel's probes.
  // Burley's shape parameter of red, green, blue; 0: the channel does not scatter.
  Vector3 d{};
  uint32_t medium = 0; // Profile id; light scatters only between surfaces with equal ids. 0: none.
};

// Probes reach up to the radius that contains this fraction of a channel's energy (KIT's
// implementation of Werner, Schuessler & Dachsbacher 2024).
inline constexpr double probe_fraction = 0.999;
// Returns that radius for d = 1: 1 - probe_fraction = (e^-r + 3 e^(-r/3)) / 4.
double reach_in_d();
// Returns the reach of the widest channel; light from further away is ignored.
double scattering_reach(const Vector3& d);

// Returns R(r) per channel and unit of area for r up to the reach, normalised so that a whole plane
// of light 1 gives 1, like the self-normalised techniques in screen space: R_c(r) / cdf_c(reach).
// Returns 0 beyond the reach and where d is 0.
Vector3 scattering_profile(const Vector3& d, double r);

// R is infinite at r = 0; radii below this many d use the value at this radius. The fraction of
// energy below it is 5e-7.
inline constexpr double min_radius_in_d = 1e-6;

// Returns axis number `axis % 3` of an orthonormal basis: the normal and two tangents (Duff et al.
// 2017, "Building an orthonormal basis, revisited").
Vector3 probe_axis(const Vector3& normal, uint32_t axis);

// Returns the integrand without visibility: light of `irradiance` at distance r that reaches x1.
// The result is diffuse light before albedo, with C = F_t = 1: as in screen space, the incoming
// light contains both factors.
inline Vector3 scattered(const Domain& domain, double r, const Vector3& irradiance) {
  return scattering_profile(domain.d, r) * irradiance;
}

// Maps a unit vector to a point of [-1, 1]^2 and back (octahedral mapping; Cigolle et al. 2014, "A
// Survey of Efficient Representations for Independent Unit Vectors").
std::array<double, 2> fold_normal(const Vector3& normal);
Vector3 unfold_normal(const std::array<double, 2>& folded);

// The stored form of a pixel of the previous frame: single floats, and the normal in two
// coordinates of 16 bits, 5e-5 rad. All zero means nothing.
using PackedDomain = std::array<uint32_t, 8>;
PackedDomain pack_domain(const Domain& domain);
Domain unpack_domain(const PackedDomain& words);

} // namespace dermis::restir
