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

// Margins as logarithms of a factor on the expected time.
class TimeMargins {
public:
  // Forgets all configurations, but not the last margin. Allocates.
  void resize(size_t configurations) { margins_.assign(configurations, 0); }

  // Returns the margin of a configuration; until it has run, that of the configuration that ran
  // last.
  double margin(uint32_t configuration) const;
  // Adds a frame of which all passes had been measured before.
  void observe(uint32_t configuration, double expected_ms, double measured_ms, double percentile);

private:
  std::vector<double> margins_; // 0: none of its own
  double last_ = 0.10;          // 97 % of frames that deviate by 5 % stay below
};

} // namespace dermis::choice
