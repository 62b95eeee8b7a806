#pragma once
// Statistics of repeated measurements.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace dermis::tools {

// Returns the smallest value that at least `fraction` of all values do not exceed (nearest rank).
// `values` must not be empty.
inline double quantile(std::vector<double> values, double fraction) {
  constexpr double rounding = 1e-9; // of the product
  const auto rank =
      static_cast<size_t>(std::ceil(fraction * static_cast<double>(values.size()) - rounding));
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(rank > 0 ? rank - 1 : 0);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

// Returns the middle value, or the mean of the two middle values. `values` must not be empty.
inline double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
}

struct Spread {
  double lowest = 0, p10 = 0, median = 0, p90 = 0;
};
inline Spread spread_of(const std::vector<double>& values) {
  return {quantile(values, 0), quantile(values, 0.1), median(values), quantile(values, 0.9)};
}

} // namespace dermis::tools
