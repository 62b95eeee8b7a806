#pragma once
// Tests of hypotheses for the laws of chance.

#include <cstdint>
#include <vector>

namespace dermis::restir::testing {

// Largest distance between the empirical distribution and the uniform one on [0, 1] times sqrt(n)
// (Kolmogorov-Smirnov).
double kolmogorov_smirnov(std::vector<double> values);
// What it exceeds with probability 1e-4 where the law holds: 2 exp(-2 k^2) = 1e-4.
inline constexpr double kolmogorov_smirnov_limit = 2.2253;

struct Mean {
  double mean = 0, sigma = 0; // of the mean
  int count = 0;
};
Mean mean_of(const std::vector<double>& values);

// |t| that Student's distribution exceeds with the two-sided probability of 3 sigma (.0027) over `tests`
// (Bonferroni).
double three_sigma_limit(int degrees_of_freedom, int tests);
// (a - b) over its spread.
double deviation(const Mean& a, const Mean& b);

} // namespace dermis::restir::testing
