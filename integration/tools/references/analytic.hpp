#pragma once
// Closed forms on an infinite plane that faces the viewer: what tests and benches compare with.
// Lengths share one unit; d > 0. Derived in polar and Hankel coordinates from R (burley_profile.hpp), A = 1.

namespace dermis::subsurface {

// Response to a half plane of light 1 at x > 0, at signed distance x from the edge:
// 1/2 + sgn(x) / 4 pi * (Ki(|x|/d) + 3 Ki(|x|/3d)), Ki(z) = integral of the Bessel function K0 from 0 to z.
// Absolute error below 1e-9.
double burley_edge(double x, double d);
// Integral of K0 from 0 to z >= 0; tends to pi / 2.
double bessel_k0_integral(double z);

// Contrast left of a sinusoid cos(k x): 1/4 / sqrt(1 + k^2 d^2) + 3/4 / sqrt(1 + 9 k^2 d^2); k in radians per
// unit.
double burley_mtf(double k, double d);

// Response at the centre of a disc of light 1 with radius rho: the cdf itself; of an annulus, the cdf's
// difference.
double burley_disc_centre(double rho, double d);
// Response at distance x from the centre of the disc. Absolute error below 1e-6.
double burley_disc(double x, double rho, double d);
// Response at the centre of light e^(-r^2 / 2 s^2).
double burley_gaussian_centre(double s, double d);

} // namespace dermis::subsurface
