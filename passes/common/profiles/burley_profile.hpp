#pragma once
// Burley's normalised diffusion profile in fp64: density, distribution, inverse, sampler, and its
// scaling by albedo. shaders/common/burley.glsl mirrors these functions under the same names.

#include <span>

namespace dermis::subsurface {

// Sources: Burley 2015 ("Extending the Disney BRDF to a BSDF with integrated subsurface
// scattering"), Christensen & Burley 2015 ("Approximate reflectance profiles for efficient
// subsurface scattering"), Golubev 2019 (exact inverse).
// All functions are pure. r and d have the same unit of length; d > 0 unless noted otherwise. The
// profile's total is 1 (albedo is multiplied in after scattering), so R below is Burley's equation
// 5.3 with A = 1.

// Smallest survival that is inverted: 24 random bits never give less, and r stays below 49.1 d.
inline constexpr double burley_min_survival = 1.0 / 16777216.0;
inline constexpr double burley_negligible_in_d = 250;

// Returns R(r) = (e^(-r/d) + e^(-r/3d)) / (8 pi d r), per unit of area. Infinite at r = 0: use
// burley_pdf if r may be 0.
double burley_R(double r, double d);
// Computes R at many radii > 0 at once, within 2e-14 of burley_R(r, d). Radii beyond
// burley_negligible_in_d, where both exponentials are below 1e-36, give the value at that radius. 0
// for d = 0. `result` must have the size of `r`.
void burley_R(std::span<const double> r, double d, std::span<double> result);
// Returns the radial density 2 pi r R(r) = (e^(-r/d) + e^(-r/3d)) / (4 d), r >= 0.
double burley_pdf(double r, double d);
// Returns the fraction of the energy within radius r: 1 - e^(-r/d)/4 - 3 e^(-r/3d)/4. 0 for r <= 0;
// 1 for d = 0 and r > 0.
double burley_cdf(double r, double d);

// Exact inverse in survival form: returns the r with 1 - cdf(r) = u. u is clamped to
// [burley_min_survival, 1]. Solves s^3 + 3 s = 4 u for s = e^(-r/3d) by the hyperbolic form of
// Cardano's formula; never negative.
double burley_inverse_survival(double u, double d);

// The sampler of the kernels: s(u) = u (1 + (1 - u^2) Q(u^2)) approximates the root above, r = -3 d
// ln s(u). The radius is within 0.52 % of the exact inverse; u is clamped as above.
double burley_sample_survival(double u, double d);
// Returns the weight that makes burley_sample_survival exactly unbiased: pdf(r) / (density of the
// sampler at r) = 3/4 (1 + s^2) s'(u). Within 1.25 % of 1, and its mean over u is 1. Independent of
// d.
double burley_sample_weight(double u);

// Approximate inverse of the slides (Golubev 2019): r = d ((2 - c) xi - 2) ln(1 - xi), c = 2.5715,
// for the cdf's value xi = 1 - u. The mean radius is 2.9 % too small; u is clamped as above.
inline constexpr double burley_approximate_c = 2.5715;
double burley_approximate_survival(double u, double d);
// Returns pdf(r) / (density of the approximate sampler at r): at least 0.945, unbounded in the
// tail; its mean over u is 1. Independent of d.
double burley_approximate_weight(double u);

// Return s(A) for a mean free path l, with d = l / s (Christensen & Burley 2015, eq. 5 and 6).
// Light that enters at one point: 1.85 - A + 7 |A - 0.8|^3. Diffuse light over the whole surface:
// 1.9 - A + 3.5 (A - 0.8)^2.
double burley_scaling_searchlight(double albedo);
double burley_scaling_diffuse(double albedo);
// Returns s(A) for a diffuse mean free path on the surface: 3.5 + 100 (A - 0.33)^4 (Christensen &
// Burley 2015, eq. 8). All three functions clamp A to [0, 1] and treat NaN as 0.33.
double burley_scaling_dmfp(double albedo);
// Returns the shape parameter d = dmfp / s(A), in the unit of dmfp. 0 (no scattering) for dmfp <= 0
// and for NaN.
double burley_d_from_dmfp(double dmfp, double albedo);

} // namespace dermis::subsurface
