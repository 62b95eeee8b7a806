#pragma once
// How many samples a pixel takes, from the spread of what it found before (SPVG and its control variates, the
// 2021 paper; ids of docs/papers.md). shaders/afis/guidance.glsl mirrors these functions under the same
// names.

#include "integration/tools/references/moving.hpp"

namespace dermis::subsurface {

// Values of the paper's section 7, but eta_cv: 1e-6 lives in no half float and never forgets.
struct GuidanceSettings {
  double sigma2_target = 1e-4; // variance of one frame's luminance that is aimed at, exposed units
  double kappa = 0.2;          // how fast a change is followed
  double eta = 0.2, eta_cv = 0.005;
  double eps_alpha = 1e-6;
  double min_samples = 8, max_samples = 64; // samples
};

// Equations 8 to 10 (A4): kappa * Delta + E, not clamped. `variance` of one frame's estimate by `mean_count`
// samples.
double wanted_samples(double variance, double mean_count, const GuidanceSettings& settings);
// A6: a whole number within [min_samples, max_samples].
int clamped_samples(double wanted, const GuidanceSettings& settings);
// Algorithm 2 (C10): (cov + eps) / (var + eps) within [0, (mean_f + mean_g) / mean_g]; 1 where all is dark,
// as the bound says nothing there.
double control_weight(const MovingCovariance& moments, double eps_alpha);

} // namespace dermis::subsurface
