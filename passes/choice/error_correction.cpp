#include "passes/choice/error_correction.hpp"

#include <algorithm>
#include <cmath>

namespace dermis::choice {
namespace {

// weight of the past at each probed frame: a memory of 25 frames, as for times
constexpr double error_memory = 0.96;
constexpr double prior_frames = 4; // weight of the table, in frames
// in both directions: the table is for other content if it deviates more
constexpr double max_factor = 4;
constexpr double wild = 3; // a frame counts at most this many times the known error

ErrorCorrection::Line& line_of(ErrorCorrection& correction, int32_t technique) {
  return correction.lines[static_cast<size_t>(technique + 1)];
}

double factor_of(const ErrorCorrection::Line& line) {
  if (line.newest <= 0) return 1;
  const double prior = prior_frames * line.newest; // weight of the table
  return std::clamp(std::sqrt((line.probed + prior) / (line.expected + prior)), 1 / max_factor,
                    max_factor);
}

} // namespace

ErrorCorrection make_error_correction(size_t techniques) {
  return {std::vector<ErrorCorrection::Line>(techniques + 1)};
}

void observe_error(ErrorCorrection& correction, int32_t technique, double probed, double expected) {
  const bool known =
      technique >= -1 && static_cast<size_t>(technique + 1) < correction.lines.size();
  if (!known || !std::isfinite(probed) || !std::isfinite(expected) || probed < 0 || expected <= 0)
    return;
  ErrorCorrection::Line& line = line_of(correction, technique);
  const double maximum = wild * factor_of(line) * expected;
  const double found = std::min(probed, maximum);
  for (ErrorCorrection::Line& other : correction.lines) {
    other.probed *= error_memory;
    other.expected *= error_memory;
  }
  line.probed += found * found;
  line.expected += expected * expected;
  line.newest = expected * expected;
}

double error_factor(const ErrorCorrection& correction, int32_t technique) {
  const auto index = static_cast<size_t>(technique + 1);
  return technique >= -1 && index < correction.lines.size() ? factor_of(correction.lines[index])
                                                            : 1.0;
}

} // namespace dermis::choice
