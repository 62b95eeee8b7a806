#include "integration/tools/references/analytic.hpp"

#include "passes/common/profiles/burley_profile.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dermis::subsurface {

namespace {

using std::numbers::pi;

// Returns e^(z^2) erfc(z) for z >= 0. Uses the asymptotic series from 10 on (Abramowitz & Stegun
// 7.1.23), error below 3e-9.
double scaled_erfc(double z) {
  if (z < 10) return std::exp(z * z) * std::erfc(z);
  const double v = 1 / (2 * z * z);
  return (1 - v * (1 - 3 * v * (1 - 5 * v * (1 - 7 * v)))) / (z * std::sqrt(pi));
}

// trapezoid rule; kinks at a disc's rim leave an error of about 1 / angles^2
constexpr int angles = 8192;

} // namespace

double bessel_k0_integral(double z) {
  if (!(z > 0)) return 0;
  // K0(x) = integral over t >= 0 of e^(-x cosh t) dt, integrated over x. The trapezoid rule
  // converges exponentially.
  constexpr double step = 0.1, last = 26;
  double sum = 0.5 * (1 - std::exp(-z));
  for (double t = step; t < last; t += step)
    sum += -std::expm1(-z * std::cosh(t)) / std::cosh(t);
  return sum * step;
}

double burley_edge(double x, double d) {
  const double size = std::abs(x);
  const double half =
      (bessel_k0_integral(size / d) + 3 * bessel_k0_integral(size / (3 * d))) / (4 * pi);
  return x < 0 ? 0.5 - half : 0.5 + half;
}

double burley_mtf(double k, double d) {
  const double f = k * d * k * d;
  return 0.25 / std::sqrt(1 + f) + 0.75 / std::sqrt(1 + 9 * f);
}

double burley_disc(double x, double rho, double d) {
  double sum = 0;
  if (std::abs(x) <= rho) {
    // Inside: integrate over directions, from the point to the rim of the disc.
    for (int i = 0; i < angles; ++i) {
      const double theta = 2 * pi * (i + 0.5) / angles;
      const double across = x * std::sin(theta);
      sum += burley_cdf(
          -x * std::cos(theta) + std::sqrt(std::max(0.0, rho * rho - across * across)), d);
    }
    return sum / angles;
  }
  // Outside: integrate between the near and the far rim, where sin(theta) = rho / x * sin(phi).
  const double ratio = rho / std::abs(x);
  for (int i = 0; i < angles; ++i) {
    const double phi = pi * ((i + 0.5) / angles - 0.5);
    const double cosine = std::sqrt(1 - ratio * ratio * std::sin(phi) * std::sin(phi));
    const double middle = std::abs(x) * cosine, half = rho * std::cos(phi);
    sum += (burley_cdf(middle + half, d) - burley_cdf(middle - half, d)) * ratio * std::cos(phi) /
           cosine;
  }
  return sum / (2 * angles);
}

double burley_gaussian_centre(double s, double d) {
  double sum = 0;
  for (const double a : {d, 3 * d})
    sum += s / (4 * d) * std::sqrt(pi / 2) * scaled_erfc(s / (std::numbers::sqrt2 * a));
  return sum;
}

} // namespace dermis::subsurface
