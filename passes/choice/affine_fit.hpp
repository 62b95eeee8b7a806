#pragma once
// Separates the cost of a dispatch from the cost of a workgroup: weighted least squares of
// milliseconds = base + per_group * groups. Used for calibrations, whose frames differ in groups.

#include <cstdint>

namespace dermis::choice {

// Coefficients >= 0.
struct AffineCost {
  double base_ms = 0, group_ms = 0;
  double ms(double groups) const { return base_ms + group_ms * groups; }
};

// Plain data; starts without observations.
struct AffineFit {
  uint64_t observations = 0;
  double moments[3] = {0, 0, 0}; // weighted sums of 1, x and x^2; x: scaled groups
  double targets[2] = {0, 0};    // weighted sums of ms and ms * x
  double deviation = 0.3;        // moving mean of |residual| / time
};

// Returns the coefficients. `prior` counts as half an observation; with `prior_known` false it only
// keeps the equations regular.
AffineCost solve(const AffineFit& fit, const AffineCost& prior, bool prior_known);
// Adds one timed run. Old runs are forgotten, outliers count less.
void observe(AffineFit& fit, const AffineCost& prior, bool prior_known, double groups, double ms);

} // namespace dermis::choice
