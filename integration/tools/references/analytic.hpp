#pragma once
// Closed-form responses on an infinite plane that faces the viewer, as references for tests and
// benches. Lengths share one unit; d > 0. Derived in polar and Hankel coordinates from R
// (burley_profile.hpp) with A = 1.

namespace dermis::subsurface {

// Returns the response to a half plane of light 1 at x > 0, at signed distance x from the edge: 1/2
// + sgn(x) / 4 pi * (Ki(|x|/d) + 3 Ki(|x|/3d)). Ki(z) is the integral of the Bessel function K0
// from 0 to z. Absolute error below 1e-9.
double burley_edge(double x, double d);
// Returns the integral of K0 from 0 to z >= 0, which tends to pi / 2.
double bessel_k0_integral(double z);

// Returns the remaining contrast of a sinusoid cos(k x): 1/4 / sqrt(1 + k^2 d^2) + 3/4 / sqrt(1 + 9
// k^2 d^2); k in radians per unit.
double burley_mtf(double k, double d);

// Returns the response at distance x from the centre of a disc of light 1 with radius rho; at the
// centre it is the cdf. Absolute error below 1e-6.
double burley_disc(double x, double rho, double d);
// Returns the response at the centre of light e^(-r^2 / 2 s^2).
double burley_gaussian_centre(double s, double d);

} // namespace dermis::subsurface
