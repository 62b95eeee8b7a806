#pragma once
// Hypothesis tests for statistical properties.

#include <cstdint>
#include <vector>

namespace dermis::restir::testing {

// Returns the Kolmogorov-Smirnov statistic: the largest distance between the empirical distribution
// and the uniform one on [0, 1], times sqrt(n).
double kolmogorov_smirnov(std::vector<double> values);
// A uniform sample exceeds this limit with probability 1e-4: 2 exp(-2 k^2) = 1e-4.
inline constexpr double kolmogorov_smirnov_limit = 2.2253;

struct Mean {
  double mean = 0, sigma = 0; // `sigma` is the standard deviation of the mean.
  int count = 0;
};
Mean mean_of(const std::vector<double>& values);

// Returns the |t| that Student's distribution exceeds with the two-sided probability of 3 sigma
// (0.0027) over `tests` (Bonferroni).
double three_sigma_limit(int degrees_of_freedom, int tests);
// Returns (a - b) over its standard deviation.
double deviation(const Mean& a, const Mean& b);

} // namespace dermis::restir::testing
