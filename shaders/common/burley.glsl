// Burley's normalised diffusion (Burley 2015; Christensen & Burley 2015).
// passes/common/profiles/burley_profile.cpp mirrors these functions in fp64 under the same names.
// All lengths are in the same unit.
#ifndef DERMIS_BURLEY_GLSL
#define DERMIS_BURLEY_GLSL

const float burley_min_survival = 5.9604644775390625e-8; // 2^-24: r <= 49 d

// Returns 2 pi r R(r), the density of the radius.
float burley_pdf(float r, float d) { return (exp(-r / d) + exp(-r / (3.0 * d))) / (4.0 * d); }

// Returns s = e^(-r/3d) for survival u, from s(u) = u (1 + (1 - u^2) Q(u^2)). The true root solves
// s^3 + 3 s = 4 u. The radius is within 0.52 % of the exact inverse; burley_sample_weight makes the
// estimate unbiased.
float burley_sample_root(float u) {
  float v = u * u;
  float q = 0.31853996 + v * (-0.26327845 + v * 0.11306352);
  return u * (1.0 + (1.0 - v) * q);
}
float burley_sample_survival(float u, float d) {
  return max(0.0, -3.0 * d * log(burley_sample_root(clamp(u, burley_min_survival, 1.0))));
}
// Returns pdf(r) divided by the sampler's density at r: 3/4 (1 + s^2) s'(u).
float burley_sample_weight(float u) {
  u = clamp(u, burley_min_survival, 1.0);
  float v = u * u;
  float q = 0.31853996 + v * (-0.26327845 + v * 0.11306352);
  float dq = -0.26327845 + v * (2.0 * 0.11306352);
  float s = u * (1.0 + (1.0 - v) * q);
  float ds = 1.0 + (1.0 - v) * q + 2.0 * v * ((1.0 - v) * dq - q);
  return 0.75 * (1.0 + s * s) * ds;
}

// Exact inverse (Golubev 2019): solves s^3 + 3 s = 4 u by the hyperbolic form of Cardano's formula.
float burley_inverse_survival(float u, float d) {
  float s = 2.0 * sinh(asinh(2.0 * clamp(u, burley_min_survival, 1.0)) / 3.0);
  return max(0.0, -3.0 * d * log(s));
}
// r = d ((2 - c) xi - 2) ln(1 - xi) with xi = 1 - u, and pdf(r) divided by the density of this r.
const float burley_approximate_c = 2.5715;
float burley_approximate_survival(float u, float d) {
  u = clamp(u, burley_min_survival, 1.0);
  return max(0.0, d * ((2.0 - burley_approximate_c) * (1.0 - u) - 2.0) * log(u));
}
float burley_approximate_weight(float u) {
  u = clamp(u, burley_min_survival, 1.0);
  float slope = 2.0 - burley_approximate_c;
  float dr = slope * log(u) - (slope * (1.0 - u) - 2.0) / u;
  return burley_pdf(burley_approximate_survival(u, 1.0), 1.0) * dr;
}

#endif
