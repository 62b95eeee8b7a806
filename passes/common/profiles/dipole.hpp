#pragma once
// The dipole approximation of multiple scattering (Jensen, Marschner, Levoy & Hanrahan 2001),
// normalised to a total of 1.

namespace dermis::subsurface {

// All functions are pure. Lengths have one unit; coefficients are per that unit. Single scattering
// is not included. dipole_albedo is the surface's own total (its diffuse albedo). R is divided by
// this total, because albedo is multiplied in after scattering.
struct Dipole {
  double z_real = 0;    // depth of the source below the surface: 1 / sigma_t'
  double z_virtual = 0; // height of the mirror image of the source: z_real (1 + 4 A / 3)
  double sigma_tr = 0;  // effective transport coefficient: sqrt(3 sigma_a sigma_t')
  bool operator==(const Dipole&) const = default;
};

// Index of refraction of skin, milk, marble and similar materials in the measurements of 2001.
inline constexpr double dipole_default_eta = 1.3;

// Returns the diffuse Fresnel reflectance from inside, -1.440 / eta^2 + 0.710 / eta + 0.668 +
// 0.0636 eta (eta > 1).
double dipole_fdr(double eta);
// Expects sigma_a > 0, sigma_s_prime > 0 (reduced scattering), eta >= 1.
Dipole make_dipole(double sigma_a, double sigma_s_prime, double eta = dipole_default_eta);
// Returns the diffuse reflectance of a half space: alpha'/2 (e^(-sigma_tr z_r) + e^(-sigma_tr
// z_v)), in (0, 1).
double dipole_albedo(double sigma_a, double sigma_s_prime, double eta = dipole_default_eta);

// Returns R(r) per unit of area: sum over both sources of z (1 + sigma_tr D) e^(-sigma_tr D) / D^3,
// D^2 = r^2 + z^2, normalised.
double dipole_R(double r, const Dipole& dipole);
// Returns 2 pi r R(r).
double dipole_pdf(double r, const Dipole& dipole);
// Returns the closed form 1 - sum (z / D) e^(-sigma_tr D) / sum e^(-sigma_tr z). 0 for r <= 0.
double dipole_cdf(double r, const Dipole& dipole);
// Returns the fraction beyond r, exact to the last digits of the tail.
double dipole_survival(double r, const Dipole& dipole);
// Returns the r with survival u, u clamped to [2^-24, 1]; relative error below 1e-12.
double dipole_inverse_survival(double u, const Dipole& dipole);
// Returns the Hankel transform of R at k radians per unit: sum e^(-z sqrt(sigma_tr^2 + k^2)) / sum
// e^(-z sigma_tr).
double dipole_transfer(double k, const Dipole& dipole);

} // namespace dermis::subsurface
