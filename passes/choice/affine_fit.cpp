#include "passes/choice/affine_fit.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace dermis::choice {
namespace {

// Chosen on recorded timings of the software driver, whose single frames deviate by up to 3 times.
constexpr double unit_groups = 1024; // scales both coefficients to similar size
constexpr double memory = 0.96;      // weight of the past at each run: a memory of 25 runs
constexpr double prior_weight = 0.5; // in runs
constexpr double no_prior_weight = 1e-3;
// residuals beyond this many typical residuals count less (Huber 1964)
constexpr double outlier = 2.0;
constexpr uint64_t settled = 4; // runs before a residual can be an outlier
constexpr double deviation_memory = 0.9;
constexpr double tiny_ms = 1e-6; // 1 ns: timestamps are no finer

} // namespace

AffineCost solve(const AffineFit& fit, const AffineCost& prior, bool prior_known) {
  if (fit.observations == 0) return prior;
  const double pull = prior_known ? prior_weight : no_prior_weight;
  const double m00 = fit.moments[0] + pull, m01 = fit.moments[1], m11 = fit.moments[2] + pull;
  const double t0 = fit.targets[0] + pull * prior.base_ms,
               t1 = fit.targets[1] + pull * prior.group_ms * unit_groups;
  const double determinant = m00 * m11 - m01 * m01; // > 0: Cauchy-Schwarz and the prior's weight
  double base = (t0 * m11 - t1 * m01) / determinant, unit = (t1 * m00 - t0 * m01) / determinant;
  if (base < 0) {
    base = 0;
    unit = std::max(0.0, t1 / m11);
  }
  if (unit < 0) { // more groups took less time: the best constant
    base = std::max(0.0, t0 / m00);
    unit = 0;
  }
  return {base, unit / unit_groups};
}

void observe(AffineFit& fit, const AffineCost& prior, bool prior_known, double groups, double ms) {
  double weight = 1;
  if (fit.observations > 0) {
    const double expected = solve(fit, prior, prior_known).ms(groups);
    const double off = std::abs(ms - expected) / std::max(expected, tiny_ms);
    if (fit.observations >= settled && off > outlier * fit.deviation)
      weight = outlier * fit.deviation / off;
    fit.deviation = deviation_memory * fit.deviation + (1 - deviation_memory) * std::min(off, 1.0);
  }
  const double x = groups / unit_groups;
  const double power[3] = {1, x, x * x};
  for (size_t i = 0; i < 3; ++i)
    fit.moments[i] = memory * fit.moments[i] + weight * power[i];
  for (size_t i = 0; i < 2; ++i)
    fit.targets[i] = memory * fit.targets[i] + weight * ms * power[i];
  ++fit.observations;
}

} // namespace dermis::choice
