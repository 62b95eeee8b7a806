#pragma once
// The artist-friendly profile: a sum of Gaussians widened per channel, and a fraction of light that
// does not scatter (Jimenez et al. 2015, "Separable subsurface scattering", section 3.6).

#include <array>

namespace dermis::subsurface {

// Red channel of skin (d'Eon, Luebke & Enderton 2007) without its narrowest Gaussian (0.233, 0.0064
// mm^2), which is the light that leaves where it entered. Variances are per axis, at a width of 1.
struct ArtistGaussian {
  double weight, variance_mm2;
};
inline constexpr std::array<ArtistGaussian, 5> artist_gaussians = {
    {{0.100, 0.0484}, {0.118, 0.187}, {0.113, 0.567}, {0.358, 1.99}, {0.078, 7.41}}};
inline constexpr double artist_total = 0.767; // sum of the weights above, which divides them
// Prevents a division by 0 in a channel without falloff.
inline constexpr double artist_min_width = 0.001;

// Returns the factor on a channel's lengths for the artist's falloff: 0.001 + falloff.
double artist_width(double falloff);

// All functions are normalised to a total of 1. `width` is artist_width times any change of units;
// r and sqrt(variance) * width have the same unit. Returns R(r) = sum of w e^(-r^2 / 2 v) / (2 pi
// v), v = variance width^2, per unit of area.
double artist_R(double r, double width);
double artist_pdf(double r, double width); // 2 pi r R(r)
double artist_cdf(double r, double width); // 1 - sum of w e^(-r^2 / 2 v); 0 for r <= 0
double artist_survival(double r, double width);
// Returns the r with survival u, u clamped to [2^-24, 1]; relative error below 1e-12.
double artist_inverse_survival(double u, double width);
// Returns the Hankel transform of R at k radians per unit: sum of w e^(-v k^2 / 2).
double artist_transfer(double k, double width);

} // namespace dermis::subsurface
