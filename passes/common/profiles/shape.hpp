#pragma once
// One channel of a profile, whatever its model: what truth, fits and tables ask of it.
//
//   L = (1 - gamma) B + gamma L_s        (table 2 of Xie, Xu & Boksansky 2021)
//
// B is the light at the point itself, L_s the light scattered to it. For Burley and the dipole gamma follows
// from the radius r0 within which light counts as unscattered; for the artist-friendly profile it is the
// artist's strength.

#include "passes/common/profiles/artist.hpp"
#include "passes/common/profiles/dipole.hpp"

#include <array>
#include <cstdint>
#include <span>

namespace dermis::subsurface {

enum class ProfileModel : uint8_t { burley, dipole, artist };

// Lengths share one unit, the caller's.
struct ChannelShape {
  ProfileModel model = ProfileModel::burley;
  // Burley's shape parameter; of another model: the d of the Burley profile with the same radius of 99 % of
  // its energy, so that radii and limits in d mean the same. 0: light passes unchanged.
  double d = 0;
  double direct = 0; // share of light that never scatters: 1 - strength of an artist-friendly channel
  Dipole dipole{};   // model dipole
  double width = 0;  // model artist
};
using ProfileShape = std::array<ChannelShape, 3>; // red, green, blue

ChannelShape burley_shape(double d);
ChannelShape dipole_shape(double sigma_a, double sigma_s_prime, double eta = dipole_default_eta);
ChannelShape artist_shape(double width, double strength);
// All lengths times `factor` >= 0.
ChannelShape scaled(const ChannelShape& shape, double factor);

// Of the scattered part, total 1; d > 0 unless said.
double shape_R(const ChannelShape& shape, double r); // per unit of area
// The same at many radii > 0 at once; 0 for d = 0. Beyond 250 d it is less than 1e-12 of its peak, and may be
// told as that.
void shape_R(const ChannelShape& shape, std::span<const double> r, std::span<double> result);
double shape_pdf(const ChannelShape& shape, double r);      // 2 pi r R(r)
double shape_cdf(const ChannelShape& shape, double r);      // 1 for d = 0 and r > 0
double shape_survival(const ChannelShape& shape, double r); // 1 - cdf
double shape_inverse_survival(const ChannelShape& shape, double u);
double shape_transfer(const ChannelShape& shape, double k); // Hankel transform; 1 for d = 0
// Share of the light that scatters further than r0, or the artist's strength.
double shape_gamma(const ChannelShape& shape, double r0);

// Radius up to which the truth counts: 20 d for Burley, for others where as much energy (.00095) lies beyond.
double shape_reach(const ChannelShape& shape);

// The radius within which a pixel's own light counts as direct. `inscribed`: half the smaller side; every tap
// within it falls on the pixel itself, so that replacing them by its light changes no mean. `circumscribed`:
// half the diagonal, as printed in the 2021 paper, section 5; it counts light of the neighbours as the
// pixel's own: 24 % too much at d = 3 px.
enum class DirectRadius : uint8_t { inscribed, circumscribed };
double direct_radius(DirectRadius mode, double width, double height);

} // namespace dermis::subsurface
