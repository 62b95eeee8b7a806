#include "passes/common/profiles/artist.hpp"

#include "passes/common/profiles/burley_profile.hpp"
#include "passes/common/profiles/invert.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dermis::subsurface {

namespace {

// Returns the sum over the Gaussians of weight * term(variance).
template <class Term> double over_gaussians(double width, Term term) {
  double sum = 0;
  for (const ArtistGaussian& one : artist_gaussians)
    sum += one.weight / artist_total * term(one.variance_mm2 * width * width);
  return sum;
}

} // namespace

double artist_width(double falloff) {
  return artist_min_width + falloff;
}

double artist_R(double r, double width) {
  return over_gaussians(
      width, [&](double v) { return std::exp(-0.5 * r * r / v) / (2 * std::numbers::pi * v); });
}

double artist_pdf(double r, double width) {
  return 2 * std::numbers::pi * r * artist_R(r, width);
}

double artist_survival(double r, double width) {
  if (!(r > 0)) return 1;
  return over_gaussians(width, [&](double v) { return std::exp(-0.5 * r * r / v); });
}

double artist_cdf(double r, double width) {
  if (!(r > 0)) return 0;
  return -over_gaussians(width, [&](double v) { return std::expm1(-0.5 * r * r / v); });
}

double artist_inverse_survival(double u, double width) {
  const double fraction = u >= burley_min_survival ? std::min(u, 1.0) : burley_min_survival;
  return invert_survival(
      fraction, width, [&](double r) { return artist_survival(r, width); },
      [&](double r) { return artist_pdf(r, width); });
}

double artist_transfer(double k, double width) {
  return over_gaussians(width, [&](double v) { return std::exp(-0.5 * v * k * k); });
}

} // namespace dermis::subsurface
