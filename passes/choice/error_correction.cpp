#include "passes/choice/error_correction.hpp"

#include <algorithm>
#include <cmath>

namespace dermis::choice {
namespace {

// weight of the past at each probed frame: a memory of 25 frames, as for times
constexpr double error_memory = 0.96;
// Bounds of a factor.
struct Belief {
  double table_frames = 0; // weight of the table
  double maximum = 1;      // in both directions
};
// The table is for other content if a technique deviates more. Light may have any unit.
constexpr Belief own_belief = {4, 4}, common_belief = {0, 1e4};
constexpr double wild = 3; // a frame counts at most this many times the known error
// Time after which a technique that does not run is worth another try.
constexpr double forgotten_s = 60;
// Factors between the contents of two frames that make measurements of one worth little to the
// other.
constexpr double other_d = 2, other_relief = 4;

double factor_of(const ErrorCorrection::Line& line, const Belief& belief) {
  if (line.newest <= 0) return 1;
  const double table = belief.table_frames * line.newest;
  return std::clamp(std::sqrt(std::max(line.probed + table, 0.0) / (line.expected + table)),
                    1 / belief.maximum, belief.maximum);
}

// Returns how much the measurements of the line say about a frame, 0 to 1.
double validity(const ErrorCorrection::Line& line, const FrameKey& key, double now_s) {
  const double d =
      std::log(std::max(key.d_px, 1e-9) / std::max(line.key.d_px, 1e-9)) / std::log(other_d);
  const double relief =
      key.relief < 0 || line.key.relief < 0
          ? 0
          : std::log((key.relief + relief_floor) / (line.key.relief + relief_floor)) /
                std::log(other_relief);
  return std::exp(-d * d - relief * relief - std::max(0.0, now_s - line.seen_s) / forgotten_s);
}

double valid_factor(const ErrorCorrection::Line& line, const Belief& belief, const FrameKey& key,
                    double now_s) {
  return line.newest > 0 ? std::pow(factor_of(line, belief), validity(line, key, now_s)) : 1;
}

// `square`: measured, in units of the table.
void observe_line(ErrorCorrection::Line& line, double square, double expected, const Belief& belief,
                  const ProbedFrame& frame) {
  const bool first = line.newest <= 0;
  const double most = first && belief.table_frames == 0
                          ? HUGE_VAL // nothing is known
                          : std::pow(wild * factor_of(line, belief) * expected, 2);
  const double kept = first ? 0 : error_memory * validity(line, frame.key, frame.now_s);
  line.probed = kept * line.probed + std::clamp(square, -most, most);
  line.expected = kept * line.expected + expected * expected;
  line.newest = expected * expected;
  line.seen_s = frame.now_s;
  line.key = frame.key;
}

// Whether the light changed at once, as if a lamp was switched: earlier frames would blame the
// technique for it.
bool is_step(const ErrorCorrection::Line& common, const ProbedFrame& frame) {
  const double known = std::pow(factor_of(common, common_belief) * frame.expected_unscattered, 2);
  return frame.unscattered_square > known * wild * wild ||
         frame.unscattered_square < known / (wild * wild);
}

} // namespace

ErrorCorrection make_error_correction(size_t techniques) {
  return {std::vector<ErrorCorrection::Line>(techniques + 1)};
}

void observe_error(ErrorCorrection& correction, const ProbedFrame& frame) {
  const auto index = static_cast<size_t>(frame.technique + 1);
  for (const double value :
       {frame.square, frame.unscattered_square, frame.expected, frame.expected_unscattered})
    if (!std::isfinite(value)) return;
  if (frame.technique < -1 || index >= correction.lines.size() || frame.expected <= 0 ||
      frame.expected_unscattered <= 0)
    return;
  ErrorCorrection::Line& common = correction.lines.front();
  if (is_step(common, frame)) common = {};
  observe_line(common, frame.unscattered_square, frame.expected_unscattered, common_belief, frame);
  if (index == 0) return;
  const double unit = std::pow(factor_of(common, common_belief), 2);
  if (unit <= std::pow(2 / common_belief.maximum, 2)) return; // even light
  observe_line(correction.lines[index], frame.square / unit, frame.expected, own_belief, frame);
}

double error_factor(const ErrorCorrection& correction, int32_t technique, const FrameKey& key,
                    double now_s) {
  const auto index = static_cast<size_t>(technique + 1);
  if (technique < -1 || index >= correction.lines.size()) return 1;
  const double common = valid_factor(correction.lines.front(), common_belief, key, now_s);
  return index == 0 ? common
                    : common * valid_factor(correction.lines[index], own_belief, key, now_s);
}

void forget_errors(ErrorCorrection& correction) {
  constexpr double age_s = 3 * forgotten_s;
  for (ErrorCorrection::Line& line : correction.lines)
    line.seen_s -= age_s;
}

} // namespace dermis::choice
