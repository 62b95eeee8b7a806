#include "tests/passes/restir/statistics.hpp"

#include <algorithm>
#include <cmath>

namespace dermis::restir::testing {

double kolmogorov_smirnov(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const double n = static_cast<double>(values.size());
  double maximum = 0;
  for (size_t i = 0; i < values.size(); ++i)
    maximum = std::max({maximum, values[i] - double(i) / n, double(i + 1) / n - values[i]});
  return maximum * std::sqrt(n);
}

Mean mean_of(const std::vector<double>& values) {
  Mean result;
  result.count = static_cast<int>(values.size());
  for (const double value : values)
    result.mean += value / result.count;
  double squares = 0;
  for (const double value : values)
    squares += (value - result.mean) * (value - result.mean);
  result.sigma = std::sqrt(squares / (result.count - 1) / result.count);
  return result;
}

double three_sigma_limit(int degrees_of_freedom, int tests) {
  const double n = degrees_of_freedom, tail_probability = 0.0026998 / tests / 2;
  const double scale =
      std::exp(std::lgamma((n + 1) / 2) - std::lgamma(n / 2)) / std::sqrt(n * 3.14159265358979);
  const auto tail = [&](double from) { // Integral over [from, inf), with t = from / s.
    constexpr int steps = 2000;
    double sum = 0;
    for (int i = 0; i < steps; ++i) {
      const double s = (i + 0.5) / steps, t = from / s;
      sum += scale * std::pow(1 + t * t / n, -(n + 1) / 2) * from / (s * s) / steps;
    }
    return sum;
  };
  double low = 1, high = 100;
  for (int i = 0; i < 60; ++i)
    (tail((low + high) / 2) > tail_probability ? low : high) = (low + high) / 2;
  return high;
}

double deviation(const Mean& a, const Mean& b) {
  return (a.mean - b.mean) / std::hypot(a.sigma, b.sigma);
}

} // namespace dermis::restir::testing
