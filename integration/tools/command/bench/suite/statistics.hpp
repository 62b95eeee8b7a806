#pragma once
// Statistics of repeated measurements.

#include <algorithm>
#include <cstddef>
#include <vector>

namespace dermis::tools {

// Returns the value at a fraction of the sorted values, by nearest rank. `values` must not be
// empty.
inline double quantile(std::vector<double> values, double fraction) {
  std::sort(values.begin(), values.end());
  return values[static_cast<size_t>(fraction * static_cast<double>(values.size() - 1) + 0.5)];
}

inline double median(std::vector<double> values) {
  return quantile(std::move(values), 0.5);
}

struct Spread {
  double lowest = 0, p10 = 0, median = 0, p90 = 0;
};
inline Spread spread_of(const std::vector<double>& values) {
  return {quantile(values, 0), quantile(values, 0.1), quantile(values, 0.5), quantile(values, 0.9)};
}

} // namespace dermis::tools
