#include "passes/choice/level_tracker.hpp"

#include <algorithm>
#include <cmath>

namespace dermis::choice {
namespace {

constexpr double deviation_gain = 0.05; // a memory of 20 observations
constexpr double min_deviation = 0.01;  // relative; timestamps are no more even
// observations after a restart before one can be an outlier
constexpr int settled_after = 4;

} // namespace

void follow(LevelTracker& tracker, double residual, double gain, double deviation) {
  const double limit = outlier_deviations * std::max(deviation, min_deviation);
  const double size = std::abs(residual);
  const int sign = residual > 0 ? 1 : -1;
  const bool outlier = tracker.since_restart >= settled_after && size > limit;
  const bool continues = sign == tracker.outlier_sign && tracker.outliers_in_a_row > 0;
  tracker.outliers_in_a_row = outlier ? (continues ? tracker.outliers_in_a_row + 1 : 1) : 0;
  tracker.smallest_outlier =
      tracker.outliers_in_a_row > 1 ? std::min(tracker.smallest_outlier, size) : size;
  tracker.outlier_sign = sign;
  if (tracker.outliers_in_a_row >= step_after)
    tracker.level += sign * tracker.smallest_outlier;
  else if (tracker.since_restart == 0)
    tracker.level += residual;
  else if (tracker.since_restart < known_after)
    tracker.level += std::min(0.0, residual); // disturbed frames are longer, never shorter
  else
    tracker.level +=
        std::max(gain, 1.0 / (tracker.since_restart + 1)) * std::clamp(residual, -limit, limit);
  tracker.deviation += deviation_gain * (std::min(size, limit) - tracker.deviation);
  ++tracker.observations;
  ++tracker.since_restart;
}

void restart(LevelTracker& tracker) {
  tracker.since_restart = 0;
}

} // namespace dermis::choice
