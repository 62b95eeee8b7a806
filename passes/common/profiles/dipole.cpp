#include "passes/common/profiles/dipole.hpp"

#include "passes/common/profiles/burley_profile.hpp"
#include "passes/common/profiles/invert.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dermis::subsurface {

namespace {

template <class Term> double over_sources(const Dipole& dipole, Term term) {
  return term(dipole.z_real) + term(dipole.z_virtual);
}

double total(const Dipole& dipole) {
  return over_sources(dipole, [&](double z) { return std::exp(-dipole.sigma_tr * z); });
}

} // namespace

double dipole_fdr(double eta) {
  return -1.440 / (eta * eta) + 0.710 / eta + 0.668 + 0.0636 * eta;
}

Dipole make_dipole(double sigma_a, double sigma_s_prime, double eta) {
  const double sigma_t = sigma_a + sigma_s_prime, fdr = dipole_fdr(eta);
  const double mismatch = (1 + fdr) / (1 - fdr);
  const double z = 1 / sigma_t;
  return {z, z * (1 + 4 * mismatch / 3), std::sqrt(3 * sigma_a * sigma_t)};
}

double dipole_albedo(double sigma_a, double sigma_s_prime, double eta) {
  const double alpha = sigma_s_prime / (sigma_a + sigma_s_prime);
  return 0.5 * alpha * total(make_dipole(sigma_a, sigma_s_prime, eta));
}

double dipole_R(double r, const Dipole& dipole) {
  const double sum = over_sources(dipole, [&](double z) {
    const double distance = std::hypot(r, z), path = dipole.sigma_tr * distance;
    return z * (1 + path) * std::exp(-path) / (distance * distance * distance);
  });
  return sum / (2 * std::numbers::pi * total(dipole));
}

double dipole_pdf(double r, const Dipole& dipole) {
  return 2 * std::numbers::pi * r * dipole_R(r, dipole);
}

double dipole_survival(double r, const Dipole& dipole) {
  if (!(r > 0)) return 1;
  const double sum = over_sources(dipole, [&](double z) {
    const double distance = std::hypot(r, z);
    return z / distance * std::exp(-dipole.sigma_tr * distance);
  });
  return sum / total(dipole);
}

double dipole_cdf(double r, const Dipole& dipole) {
  return 1 - dipole_survival(r, dipole);
}

double dipole_inverse_survival(double u, const Dipole& dipole) {
  const double fraction = u >= burley_min_survival ? std::min(u, 1.0) : burley_min_survival;
  return invert_survival(
      fraction, dipole.z_real, [&](double r) { return dipole_survival(r, dipole); },
      [&](double r) { return dipole_pdf(r, dipole); });
}

double dipole_transfer(double k, const Dipole& dipole) {
  const double decay = std::hypot(dipole.sigma_tr, k);
  return over_sources(dipole, [&](double z) { return std::exp(-decay * z); }) / total(dipole);
}

} // namespace dermis::subsurface
