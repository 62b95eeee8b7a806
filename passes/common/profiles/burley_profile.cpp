#include "passes/common/profiles/burley_profile.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dermis::subsurface {

namespace {

// Q(v), second degree, by least squares on the radius: maximum relative error of r 0.50 %.
constexpr double q0 = 0.31853996, q1 = -0.26327845, q2 = 0.11306352;
constexpr double scaling_centre = 0.33;

double clamp_survival(double u) {
  // a NaN becomes the minimum
  return u >= burley_min_survival ? std::min(u, 1.0) : burley_min_survival;
}

double clamp_albedo(double albedo) {
  return std::isnan(albedo) ? scaling_centre : std::clamp(albedo, 0.0, 1.0);
}

} // namespace

double burley_R(double r, double d) {
  const double t = std::exp(-r / (3 * d));
  return t * (1 + t * t) / (8 * std::numbers::pi * d * r);
}

double burley_pdf(double r, double d) {
  const double t = std::exp(-r / (3 * d));
  return t * (1 + t * t) / (4 * d);
}

double burley_cdf(double r, double d) {
  if (!(r > 0)) return 0;
  if (!(d > 0)) return 1;
  // expm1 keeps the digits of small radii, where both exponentials are close to 1. With e =
  // e^(-r/3d) - 1, the other exponential is (1 + e)^3.
  const double e = std::expm1(-r / (3 * d));
  return -e * (1.5 + e * (0.75 + e * 0.25));
}

double burley_inverse_survival(double u, double d) {
  const double s = 2 * std::sinh(std::asinh(2 * clamp_survival(u)) / 3);
  return std::max(0.0, -3 * d * std::log(s));
}

double burley_sample_survival(double u, double d) {
  const double x = clamp_survival(u), v = x * x;
  const double s = x * (1 + (1 - v) * (q0 + v * (q1 + v * q2)));
  return std::max(0.0, -3 * d * std::log(s));
}

double burley_sample_weight(double u) {
  const double x = clamp_survival(u), v = x * x;
  const double q = q0 + v * (q1 + v * q2), dq = q1 + 2 * q2 * v;
  const double s = x * (1 + (1 - v) * q);
  const double ds = 1 + (1 - 3 * v) * q + 2 * v * (1 - v) * dq;
  return 0.75 * (1 + s * s) * ds;
}

double burley_approximate_survival(double u, double d) {
  const double x = clamp_survival(u);
  return std::max(0.0, d * ((2 - burley_approximate_c) * (1 - x) - 2) * std::log(x));
}

double burley_approximate_weight(double u) {
  const double x = clamp_survival(u), slope = 2 - burley_approximate_c;
  const double dr = slope * std::log(x) - (slope * (1 - x) - 2) / x; // dr / d xi, in d
  return burley_pdf(burley_approximate_survival(x, 1), 1) * dr;
}

double burley_scaling_searchlight(double albedo) {
  const double a = clamp_albedo(albedo), e = std::abs(a - 0.8);
  return 1.85 - a + 7 * e * e * e;
}

double burley_scaling_diffuse(double albedo) {
  const double a = clamp_albedo(albedo), e = a - 0.8;
  return 1.9 - a + 3.5 * e * e;
}

double burley_scaling_dmfp(double albedo) {
  const double a = clamp_albedo(albedo);
  const double e = (a - scaling_centre) * (a - scaling_centre);
  return 3.5 + 100 * e * e;
}

double burley_d_from_dmfp(double dmfp, double albedo) {
  return dmfp > 0 ? dmfp / burley_scaling_dmfp(albedo) : 0.0;
}

} // namespace dermis::subsurface
