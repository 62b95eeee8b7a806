#include "passes/choice/error_correction.hpp"

#include <algorithm>
#include <cmath>

namespace dermis::choice {
namespace {

// weight of the past at each probed frame: a memory of 25 frames, as for times
constexpr double error_memory = 0.96;
// Bounds of a factor.
struct Prior {
  double table_frames = 0; // weight of the table
  double maximum = 1;      // in both directions
  double factor = 1;       // on the table, before any measurement
};
// A factor beyond is noise. Light may have any unit.
constexpr Prior technique_prior = {2, 16}, common_prior = {0, 1e4};
constexpr double outlier_limit = 3; // a frame counts at most this many times the known error
constexpr int frames_of_a_step = 3; // that deviate more, in the same direction
// Frames in which a smaller fraction of the tiles is selected, or left out, are ignored.
constexpr double min_selected = 0.02;
// Bounds of the exponent, beyond those measured: 0.3 (tile_selection.hpp) to 11.
constexpr double min_concentration = 0.05, max_concentration = 12;
// Time after which a technique that does not run is worth another try.
constexpr double forgotten_s = 60;
constexpr double age_of_a_cut = 3; // times forgotten_s
// Factors between the contents of two frames that make measurements of one worth little to the
// other.
constexpr double other_d = 2, other_relief = 4;

// Returns whether the errors of two techniques rise and fall together between scenes. A technique
// at half resolution is not a variant: its errors are others.
bool are_variants(const TechniqueError& a, const TechniqueError& b) {
  return !a.pass_types.empty() && !b.pass_types.empty() &&
         a.pass_types.front().type == b.pass_types.front().type;
}

// Returns the exponent with which the factor of a measured technique holds for a variant of it: the
// ratio of the spreads of their errors, at most 1. 1 if a spread was not measured.
double shared_fraction(const TechniqueError& measured, const TechniqueError& variant, double d_px) {
  const double from = std::log(spread_at(measured.curve, d_px)),
               to = std::log(spread_at(variant.curve, d_px));
  return from > 0 && to > 0 ? std::min(to / from, 1.0) : 1;
}

double factor_of(const ErrorCorrection::Line& line, const Prior& prior) {
  if (line.frames <= 0) return prior.factor;
  const double table = prior.table_frames * line.expected / line.frames;
  const double expected_by_table = prior.factor * prior.factor * table;
  return std::clamp(
      std::sqrt(std::max(line.probed + expected_by_table, 0.0) / (line.expected + table)),
      1 / prior.maximum, prior.maximum);
}

// Returns how much the measurements of the line say about a frame, 0 to 1.
double validity(const ErrorCorrection::Line& line, const FrameKey& key, double now_s,
                bool cut = false) {
  const double d =
      std::log(std::max(key.d_px, 1e-9) / std::max(line.key.d_px, 1e-9)) / std::log(other_d);
  const double relief =
      key.relief < 0 || line.key.relief < 0
          ? 0
          : std::log((key.relief + relief_floor) / (line.key.relief + relief_floor)) /
                std::log(other_relief);
  const double age =
      std::max(0.0, now_s - line.seen_s) / forgotten_s + age_of_a_cut * (line.cuts + (cut ? 1 : 0));
  return std::exp(-d * d - relief * relief - age);
}

double valid_factor(const ErrorCorrection::Line& line, const Prior& prior, const FrameKey& key,
                    double now_s, bool cut) {
  const double valid = line.frames > 0 ? validity(line, key, now_s, cut) : 0;
  return std::pow(factor_of(line, prior), valid) * std::pow(prior.factor, 1 - valid);
}

// Returns what measurements of the other variants of a technique say about it: its factor is
// expected to deviate from 1 as theirs do, in units of the spreads between scenes.
Prior prior_of(const ErrorCorrection& correction, size_t technique, const FrameKey& key,
               double now_s, bool cut = false) {
  const TechniqueError& own = correction.techniques[technique];
  double logs = 0, frames = 0;
  for (size_t t = 0; t < correction.techniques.size(); ++t) {
    const ErrorCorrection::Line& line = correction.lines[t + 1];
    const TechniqueError& other = correction.techniques[t];
    if (t == technique || line.frames <= 0 || !are_variants(own, other)) continue;
    const double valid_frames = line.frames * validity(line, key, now_s, cut);
    logs += valid_frames * shared_fraction(other, own, key.d_px) *
            std::log(valid_factor(line, technique_prior, key, now_s, cut));
    frames += valid_frames;
  }
  Prior prior = technique_prior;
  if (frames > 0) prior.factor = std::exp(logs / frames);
  return prior;
}

// Adds squares of a frame: measured, and expected by the table.
void observe_line(ErrorCorrection::Line& line, double square, double expected, const Prior& prior,
                  const ProbedFrame& frame) {
  const bool first = line.frames <= 0;
  const double most = first && prior.table_frames == 0
                          ? HUGE_VAL // nothing is known
                          : std::pow(outlier_limit * factor_of(line, prior), 2) * expected;
  const double kept = first ? 0 : error_memory * validity(line, frame.key, frame.now_s);
  line.probed = kept * line.probed + std::clamp(square, -most, most);
  line.expected = kept * line.expected + expected;
  line.frames = kept * line.frames + 1;
  line.seen_s = frame.now_s;
  line.cuts = 0;
  line.key = frame.key;
}

// Returns the light, in units of the table's, above which a frame counts less: a frame of rare
// light does not outweigh others.
double light_limit(const ErrorCorrection& correction) {
  return std::pow(outlier_limit * factor_of(correction.lines.front(), common_prior), 2);
}

// Adds the square of a technique, compared with the light of the same pixels: what they happen to
// show, and how bright it is, are no error of the technique. `light`: square of that light in units
// of the table's.
void observe_technique(ErrorCorrection& correction, size_t index, double square, double expected,
                       double light, const ProbedFrame& frame) {
  const double weight = std::min(1.0, light_limit(correction) / light);
  const Prior prior = prior_of(correction, index - 1, frame.key, frame.now_s);
  observe_line(correction.lines[index], weight * square, weight * light * expected * expected,
               prior, frame);
}

// Adds what a selection of tiles left of the light's error. `light`: as in observe_technique.
void observe_selection(ErrorCorrection& correction, double light, const ProbedFrame& frame) {
  if (!(frame.selected > min_selected && frame.selected < 1 - min_selected)) return;
  ErrorCorrection::Line& line = correction.selection;
  const double kept = line.frames > 0 ? error_memory * validity(line, frame.key, frame.now_s) : 0;
  const double weight = std::min(1.0, light_limit(correction) / light);
  correction.selection_log =
      (kept * line.frames * correction.selection_log + std::log1p(-frame.selected)) /
      (kept * line.frames + 1);
  line.probed = kept * line.probed + weight * (frame.selection_square - frame.compared_square);
  line.expected =
      kept * line.expected + weight * (frame.unscattered_square - frame.compared_square);
  line.frames = kept * line.frames + 1;
  line.seen_s = frame.now_s;
  line.cuts = 0;
  line.key = frame.key;
}

// Returns the square of unscattered light that the common factor predicts.
double known_square(const ErrorCorrection& correction, const ProbedFrame& frame) {
  return std::pow(factor_of(correction.lines.front(), common_prior) * frame.expected_unscattered,
                  2);
}

// Restarts the common factor once the light has changed at once, as if a lamp was switched. Single
// frames tell nothing: the few tiles that are probed may miss all detail, or only hit detail.
void follow_step(ErrorCorrection& correction, const ProbedFrame& frame) {
  constexpr double limit = outlier_limit * outlier_limit;
  const double known = known_square(correction, frame);
  const int sign = frame.unscattered_square > known * limit   ? 1
                   : frame.unscattered_square < known / limit ? -1
                                                              : 0;
  correction.steps = sign != 0 && sign * correction.steps > 0 ? correction.steps + sign : sign;
  if (std::abs(correction.steps) < frames_of_a_step) return;
  correction.lines.front() = {};
  correction.steps = 0;
}

} // namespace

ErrorCorrection make_error_correction(const ErrorModel& table) {
  ErrorCorrection correction;
  correction.lines.resize(table.techniques.size() + 1);
  correction.techniques = table.techniques;
  correction.compared =
      find_technique(table, {{"subsurface.separable", {{"taps", "25"}, {"kernel", "fitted"}}}});
  return correction;
}

void observe_error(ErrorCorrection& correction, const ProbedFrame& frame) {
  const auto index = static_cast<size_t>(frame.technique + 1);
  for (const double value :
       {frame.square, frame.unscattered_square, frame.expected, frame.expected_unscattered,
        frame.compared_square, frame.selection_square})
    if (!std::isfinite(value)) return;
  if (frame.technique < -1 || index >= correction.lines.size() || frame.expected <= 0 ||
      frame.expected_unscattered <= 0)
    return;
  follow_step(correction, frame);
  const double table = frame.expected_unscattered * frame.expected_unscattered;
  observe_line(correction.lines.front(), frame.unscattered_square, table, common_prior, frame);
  const double light = frame.unscattered_square / table;      // in units of the table's light
  if (light <= std::pow(2 / common_prior.maximum, 2)) return; // uniform light
  if (index != 0) observe_technique(correction, index, frame.square, frame.expected, light, frame);
  if (correction.compared >= 0 && correction.compared != frame.technique &&
      frame.compared_expected > 0)
    observe_technique(correction, static_cast<size_t>(correction.compared + 1),
                      frame.compared_square, frame.compared_expected, light, frame);
  observe_selection(correction, light, frame);
}

double error_factor(const ErrorCorrection& correction, int32_t technique, const FrameKey& key,
                    double now_s, bool cut) {
  const auto index = static_cast<size_t>(technique + 1);
  if (technique < -1 || index >= correction.lines.size()) return 1;
  const double common = valid_factor(correction.lines.front(), common_prior, key, now_s, cut);
  if (index == 0) return common;
  const Prior prior = prior_of(correction, index - 1, key, now_s, cut);
  return common * valid_factor(correction.lines[index], prior, key, now_s, cut);
}

double measured_frames(const ErrorCorrection& correction, int32_t technique, const FrameKey& key,
                       double now_s, bool cut) {
  const auto index = static_cast<size_t>(technique + 1);
  if (technique < -1 || index >= correction.lines.size()) return 0;
  const ErrorCorrection::Line& line = correction.lines[index];
  return line.frames > 0 ? line.frames * validity(line, key, now_s, cut) : 0;
}

double selection_concentration(const ErrorCorrection& correction, double expected,
                               const FrameKey& key, double now_s, bool cut) {
  const ErrorCorrection::Line& line = correction.selection;
  if (line.frames <= 0 || !(line.expected > 0)) return expected;
  const double mean = line.expected / line.frames, prior = technique_prior.table_frames * mean;
  const double left = (line.probed + prior * std::exp(expected * correction.selection_log)) /
                      (line.expected + prior);
  const double measured =
      std::clamp(std::log(std::clamp(left, 1e-6, 1.0)) / correction.selection_log,
                 min_concentration, max_concentration);
  return expected * std::pow(measured / expected, validity(line, key, now_s, cut));
}

void forget_errors(ErrorCorrection& correction) {
  for (ErrorCorrection::Line& line : correction.lines)
    ++line.cuts;
  ++correction.selection.cuts;
}

void recall_errors(ErrorCorrection& correction) {
  for (ErrorCorrection::Line& line : correction.lines)
    line.cuts -= line.cuts > 0 ? 1 : 0;
  correction.selection.cuts -= correction.selection.cuts > 0 ? 1 : 0;
}

} // namespace dermis::choice
