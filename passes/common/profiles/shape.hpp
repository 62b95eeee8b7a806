#pragma once
// One channel of a profile of any model, as used by the reference, fits and tables.
//
//   L = (1 - gamma) B + gamma L_s        (table 2 of Xie, Xu & Boksansky 2021)
//
// B is the light at the point itself, L_s the light scattered to it. For Burley and the dipole,
// gamma follows from the radius r0 within which light counts as unscattered. For the
// artist-friendly profile, gamma is the artist's strength.

#include "passes/common/profiles/artist.hpp"
#include "passes/common/profiles/dipole.hpp"

#include <array>
#include <cstdint>
#include <span>

namespace dermis::subsurface {

enum class ProfileModel : uint8_t { burley, dipole, artist };

// Lengths have one unit, which the caller chooses.
struct ChannelShape {
  ProfileModel model = ProfileModel::burley;
  // Burley's shape parameter. For another model: d of the Burley profile with the same radius of 99
  // % of the energy, so that radii and limits in d are comparable. 0: light passes unchanged.
  double d = 0;
  // fraction of light that never scatters: 1 - strength of an artist-friendly channel
  double direct = 0;
  Dipole dipole{};  // only model dipole
  double width = 0; // only model artist
  bool operator==(const ChannelShape&) const = default;
};
using ProfileShape = std::array<ChannelShape, 3>; // red, green, blue

ChannelShape burley_shape(double d);
ChannelShape dipole_shape(double sigma_a, double sigma_s_prime, double eta = dipole_default_eta);
ChannelShape artist_shape(double width, double strength);
// Returns the shape with all lengths times `factor` >= 0.
ChannelShape scaled(const ChannelShape& shape, double factor);

// The functions below describe the scattered part, with a total of 1; d > 0 unless noted otherwise.
double shape_R(const ChannelShape& shape, double r); // per unit of area
// Computes R at many radii > 0 at once; 0 for d = 0. Radii beyond 250 d, where R is less than 1e-12
// of its peak, may give 0 or the value at 250 d.
void shape_R(const ChannelShape& shape, std::span<const double> r, std::span<double> result);
double shape_pdf(const ChannelShape& shape, double r);      // 2 pi r R(r)
double shape_cdf(const ChannelShape& shape, double r);      // 1 for d = 0 and r > 0
double shape_survival(const ChannelShape& shape, double r); // 1 - cdf
double shape_inverse_survival(const ChannelShape& shape, double u);
double shape_transfer(const ChannelShape& shape, double k); // Hankel transform; 1 for d = 0
// Returns the fraction of the light that scatters further than r0, or the artist's strength.
double shape_gamma(const ChannelShape& shape, double r0);

// Returns the radius of the reference: 20 d for Burley; for other models the radius with the same
// energy beyond (0.00095).
double shape_reach(const ChannelShape& shape);

// Returns the radius within which a pixel's own light counts as direct.
// - `inscribed`: half the smaller side. Every tap within this radius falls on the pixel itself, so
//   that replacing such taps by its light does not change the mean.
// - `circumscribed`: half the diagonal, as printed in the 2021 paper, section 5. Counts light of
//   the neighbours as the pixel's own: 24 % too much at d = 3 px.
enum class DirectRadius : uint8_t { inscribed, circumscribed };
double direct_radius(DirectRadius mode, double width, double height);

} // namespace dermis::subsurface
