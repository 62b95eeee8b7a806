#pragma once
// What a pixel fixes of a path camera - x1 - x2 - light: its first hit x1 and how light scatters to it.
// shaders/restir/domain.glsl mirrors these functions under the same names. Pure; thread: any.

#include "tests/passes/restir/cpu/vector.hpp"

#include <array>
#include <cstdint>

namespace dermis::restir {

// Lengths share one unit, the caller's.
struct Domain {
  Vector3 position{};  // x1
  Vector3 normal{};    // unit length: the first axis of its probes
  Vector3 d{};         // Burley's shape parameter of red, green, blue; 0: the channel does not scatter
  uint32_t medium = 0; // profile id; light scatters between surfaces of the same id only. 0: none
};

// Probes reach to where this share of a channel's energy lies (KIT's implementation of Werner, Schuessler &
// Dachsbacher 2024; subsurface.md R11).
inline constexpr double probe_fraction = 0.999;
// That radius for d = 1: 1 - probe_fraction = (e^-r + 3 e^(-r/3)) / 4.
double reach_in_d();
// Of the widest channel: light from further away does not count.
double scattering_reach(const Vector3& d);

// R(r) per channel and unit of area, for r up to the reach and so that a whole plane of light 1 gives 1, as
// the self-normalised techniques in screen space have it: R_c(r) / cdf_c(reach). 0 beyond, and where d is 0.
Vector3 scattering_profile(const Vector3& d, double r);

// R is infinite at r = 0; radii below this many d count as it. Its share of the energy is 5e-7.
inline constexpr double min_radius_in_d = 1e-6;

// Three axes at right angles: the normal and two tangents (Duff et al. 2017, "Building an orthonormal basis,
// revisited"); axis % 3.
Vector3 probe_axis(const Vector3& normal, uint32_t axis);

// The integrand but for visibility: light of `irradiance` at distance r that reaches x1. Diffuse light before
// albedo, C = F_t = 1: as in screen space the light that comes in has them in it.
inline Vector3 scattered(const Domain& domain, double r, const Vector3& irradiance) {
  return scattering_profile(domain.d, r) * irradiance;
}

// A unit vector as a point of [-1, 1]^2 (Cigolle et al. 2014, "A Survey of Efficient Representations for
// Independent Unit Vectors": the octahedron), and back.
std::array<double, 2> fold_normal(const Vector3& normal);
Vector3 unfold_normal(const std::array<double, 2>& folded);

// What a pixel of the frame before is remembered by: single floats, the normal in 16 bits for each of two
// coordinates, 5e-5 rad. All zero: nothing.
using PackedDomain = std::array<uint32_t, 8>;
PackedDomain pack_domain(const Domain& domain);
Domain unpack_domain(const PackedDomain& words);

} // namespace dermis::restir
