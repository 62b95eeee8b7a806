#pragma once
// Sample count of a pixel from the variance of earlier estimates (SPVG and its control variates,
// the 2021 paper; ids of docs/papers.md). shaders/afis/guidance.glsl mirrors these functions under
// the same names.

#include "integration/tools/references/moving.hpp"

namespace dermis::subsurface {

// Values of the paper's section 7, except eta_cv: the paper's 1e-6 is not representable in half
// floats and never forgets.
struct GuidanceSettings {
  double sigma2_target = 1e-4; // target variance of one frame's exposed luminance
  double kappa = 0.2;          // rate at which the count follows a change
  double eta = 0.2, eta_cv = 0.005;
  double eps_alpha = 1e-6;
  double min_samples = 8, max_samples = 64; // samples per pixel
};

// Returns kappa * Delta + E, not clamped (equations 8 to 10, A4). `variance` is of one frame's
// estimate with `mean_count` samples.
double required_samples(double variance, double mean_count, const GuidanceSettings& settings);
// Rounds to a whole number within [min_samples, max_samples] (A6).
int clamped_samples(double required, const GuidanceSettings& settings);
// Returns (cov + eps) / (var + eps), clamped to [0, (mean_f + mean_g) / mean_g] (algorithm 2, C10).
// Not clamped if mean_g is 0, where the upper bound is undefined; all black gives 1.
double control_weight(const MovingCovariance& moments, double eps_alpha);

} // namespace dermis::subsurface
