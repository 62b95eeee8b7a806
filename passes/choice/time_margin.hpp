#pragma once
// Margin between the expected time of a frame and the time that a given percentile of frames stays
// below, by configuration. Follows the quantile of measured over expected time: a late frame widens
// the margin, any other frame narrows it. The fraction of late frames converges to 1 - percentile
// for any distribution (adaptive conformal inference, Gibbs and Candès 2021).

#include <cstddef>
#include <cstdint>
#include <vector>

namespace dermis::choice {

// Margin of the calibrated times of DERMIS_BUDGET_DETERMINISTIC, as a logarithm.
inline constexpr double calibrated_margin = 0.05;
// Margin before any frame: 97 % of frames that deviate by 5 % stay below.
inline constexpr double first_margin = 0.10;

// Margins as logarithms of a factor on the expected time.
class TimeMargins {
public:
  // Forgets all configurations; each starts with `margin`. Allocates.
  void restart(size_t configurations, double margin);

  // Returns the margin of a configuration; until it has run, that of the configuration that ran
  // last.
  double margin(uint32_t configuration) const;
  // Adds a frame of which all passes had been measured before. Returns the new margin.
  double observe(uint32_t configuration, double expected_ms, double measured_ms, double percentile);

private:
  std::vector<double> margins_; // 0: none of its own
  double last_ = first_margin;
};

} // namespace dermis::choice
