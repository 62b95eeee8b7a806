#include "passes/choice/time_margin.hpp"

#include <algorithm>
#include <cmath>

namespace dermis::choice {
namespace {

constexpr double step = 0.03; // a late frame widens the margin by at most this fraction
// As step, for a configuration that does not run: it approaches the margin of what runs, halving it
// in 100 s. At the speed of step, some would return too early, and be late.
constexpr double resting_step = step / 10;
constexpr double min_margin = 0.02, max_margin = 0.5;
// Fraction of the late frames that are kept in reserve, for levels that drift.
constexpr double reserve = 0.2;

} // namespace

void TimeMargins::restart(size_t configurations, double margin) {
  margins_.assign(configurations, 0);
  last_ = margin;
}

double TimeMargins::margin(uint32_t configuration) const {
  const double own = configuration < margins_.size() ? margins_[configuration] : 0;
  return own > 0 ? own : last_;
}

double TimeMargins::observe(uint32_t configuration, double expected_ms, double measured_ms,
                            double percentile) {
  const double before = margin(configuration);
  const double aim = percentile + reserve * (1 - percentile);
  const bool late = measured_ms > expected_ms * std::exp(before);
  last_ = std::clamp(before * (1 + step * (late ? aim : aim - 1)), min_margin, max_margin);
  margins_[configuration] = last_;
  // The noise that widened a margin may be over.
  for (double& other : margins_)
    if (other > last_) other = std::max(last_, other * (1 + resting_step * (aim - 1)));
  return last_;
}

} // namespace dermis::choice
