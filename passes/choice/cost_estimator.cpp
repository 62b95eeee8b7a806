#include "passes/choice/cost_estimator.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace dermis::choice {
namespace {

constexpr double device_gain = 0.15, own_gain = 0.05; // memories of 7 and 20 frames
// Lines with this many observations and this even times may show a change of the device.
constexpr int even_after = 8;
constexpr double even_deviation = 0.3;
// Lines below this fraction of a frame are too short to say anything about the device.
constexpr double min_fraction = 0.01;
// Observations after which a line knows its usual level: one second.
constexpr int usual_after = 60;
// The usual level falls within 8 s and rises within 17 s, so that a disturbance does not become
// usual before it ends.
constexpr double usual_fall = 0.002, usual_rise = 0.001;
// Fraction per frame of the mean distance from the usual levels that the device takes over.
// Without it the split into device and work drifts, and work that does not run is misjudged.
constexpr double recenter_gain = 0.05;
constexpr double disturbed = 0.10; // above the usual level by more: disturbed, as a logarithm
// A line may have changed after this time without observation, and at least this many frames.
constexpr double absent_s = 0.5, absent_frames = 4;
// Work that does not run may have become cheaper: as a logarithm, for each doubling of 30 minutes.
constexpr double forgotten = 0.2, forgotten_after_s = 1800;
constexpr double pessimism = 1.0 / 3; // fraction of the uncertainty that the upper bound adds
// Fraction of the optimism that work keeps if it took too long before its usual level was known.
constexpr double kept_optimism = 0.25;
// Cost of unknown work without any calibration: a small dispatch on a slow device.
constexpr AffineCost unknown_cost = {0.01, 1e-4};
constexpr AffineCost unknown_command = {0.005, 0}; // for example a clear of a small buffer

std::string_view next_word(std::string_view& text) {
  const size_t end = std::min(text.find(' '), text.size());
  const std::string_view word = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return word;
}

// Returns 0 for different pass types; else 1 + the number of equal settings, which are in the same
// order.
size_t words_alike(std::string_view a, std::string_view b) {
  if (next_word(a) != next_word(b)) return 0;
  size_t count = 1;
  while (!a.empty() && !b.empty())
    count += next_word(a) == next_word(b) ? 1 : 0;
  return count;
}

// Keeps as many costs as a calibration may have: those with the most observations.
void keep_most_observed(std::vector<Cost>& costs, const std::vector<int>& observations) {
  std::vector<size_t> order(costs.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](size_t a, size_t b) { return observations[a] > observations[b]; });
  order.resize(max_calibrated_costs);
  std::vector<Cost> kept;
  for (const size_t i : order)
    kept.push_back(std::move(costs[i]));
  costs = std::move(kept);
}

} // namespace

CostEstimator::CostEstimator(std::vector<Cost> calibration, double uncertainty) {
  for (Cost& cost : calibration) {
    Line& line = lines_.emplace_back();
    line.work = std::move(cost.work);
    line.prior = {cost.base_us * 1e-3, cost.group_us * 1e-3};
    line.fit.deviation = cost.spread;
    line.stated = cost.uncertainty;
    line.has_prior = true;
  }
  factors_.resize(lines_.size());
  timed_.resize(lines_.size());
  set_uncertainty(uncertainty);
}

void CostEstimator::set_uncertainty(double uncertainty, bool for_all) {
  uncertainty_ = uncertainty;
  for (Line& line : lines_) {
    line.uncertainty = for_all || line.stated == 0 ? uncertainty : line.stated;
    line.pessimism = std::pow(line.uncertainty, pessimism);
  }
}

CostId CostEstimator::add(std::string_view work, bool launches) {
  for (uint32_t i = 0; i < lines_.size(); ++i)
    if (lines_[i].work == work) {
      lines_[i].used = true;
      return {i};
    }
  Line line;
  line.work = work;
  line.used = true;
  line.prior = launches ? unknown_cost : unknown_command;
  line.guess = true;
  line.uncertainty = uncertainty_;
  line.pessimism = std::pow(uncertainty_, pessimism);
  const Line* like = placeholder_for(work);
  if (like != nullptr && (launches || words_alike(like->work, work) > 0)) {
    line.prior = like->prior; // without measurements, for choices by the calibration only
    line.has_prior = line.placeholder = true;
    // With another setting the pass will take about as much as it took.
    if (like->own.observations > 0 && (!like->has_prior || words_alike(like->work, work) > 0))
      line.measured_like = like->own_factor / unmeasured_factor_;
    line.guess = like->guess || words_alike(like->work, work) == 0;
  }
  // first, so that a failure leaves enough elements for all lines
  factors_.resize(lines_.size() + 1);
  timed_.resize(lines_.size() + 1);
  lines_.push_back(std::move(line));
  return {static_cast<uint32_t>(lines_.size() - 1)};
}

void CostEstimator::retire_all() noexcept {
  for (Line& line : lines_)
    line.used = false;
}

const CostEstimator::Line* CostEstimator::placeholder_for(std::string_view work) const {
  const Line* best = nullptr;
  size_t maximum = 0;
  for (const Line& line : lines_) {
    if (!line.has_prior && line.own.observations == 0) continue;
    const size_t alike = words_alike(line.work, work);
    if (alike > maximum) {
      maximum = alike;
      best = &line;
    }
  }
  if (best != nullptr) return best;
  const auto costs_less = [](const Line& a, const Line& b) {
    return a.prior.group_ms < b.prior.group_ms;
  };
  const auto costliest = std::max_element(lines_.begin(), lines_.end(), costs_less);
  return costliest != lines_.end() ? &*costliest : nullptr;
}

bool CostEstimator::has_calibration(CostId id) const {
  const Line& line = lines_[id.value];
  return !line.guess || line.own.observations > 0;
}

double CostEstimator::factor(const Line& line) const {
  return device_factor_ *
         (line.own.observations > 0 ? line.own_factor : unmeasured_factor_ * line.measured_like);
}

// Returns what the calibration expects of a line on this device.
AffineCost CostEstimator::expected_cost(const Line& line) const {
  const double scale = device_factor_ * unmeasured_factor_ * line.measured_like;
  return {line.prior.base_ms * scale, line.prior.group_ms * scale};
}

std::span<const CostFactors> CostEstimator::predict(double now_s) {
  // Without timestamps, running work does not show what it takes.
  const bool timed = !is_absent(observed_s_, now_s);
  const double min_unmeasured = std::exp(-std::max(0.0, unmeasured_));
  double last_age = 0, remembered = 1; // lines that stopped in the same frame share the power
  for (size_t l = 0; l < lines_.size(); ++l) {
    Line& line = lines_[l];
    if (!line.used) continue;
    if (line.seen_s < 0) line.seen_s = now_s;
    const double age = std::max(0.0, now_s - line.seen_s);
    const bool never = line.own.observations == 0, absent = is_absent(line.seen_s, now_s);
    CostFactors& out = factors_[l];
    out.expected = out.pessimistic = out.optimistic = out.undisturbed = out.usual = factor(line);
    out.measured = !never && !absent && line.own.since_restart >= known_after;
    if (never) out.pessimistic *= line.pessimism;
    if (!timed || (!never && !absent)) continue;
    if (age != last_age) {
      last_age = age;
      remembered = std::exp(-forgotten * std::log2(1 + age / forgotten_after_s));
    }
    if (never) out.optimistic *= min_unmeasured / line.uncertainty * remembered;
    if (line.own.observations > usual_after) out.usual *= line.usual_ratio;
    out.undisturbed = never ? out.optimistic : out.undisturbed * line.usual_ratio * remembered;
  }
  return factors_;
}

size_t CostEstimator::unmeasured() const {
  return static_cast<size_t>(std::count_if(lines_.begin(), lines_.end(), [](const Line& line) {
    return line.used && line.own.observations == 0;
  }));
}

bool CostEstimator::is_absent(double seen_s, double now_s) const {
  return now_s - seen_s > std::max(absent_s, absent_frames * interval_s_);
}

void CostEstimator::observe(std::span<const PassTime> passes, double now_s) {
  // The shorter of two intervals: a single pause is not the frame rate.
  const double before_s = observed_s_;
  const double interval_s = before_s >= 0 ? now_s - before_s : 0;
  interval_s_ = std::min(interval_s, last_interval_s_);
  last_interval_s_ = interval_s;
  observed_s_ = now_s;
  collect(passes, now_s, before_s);
  follow_device();
  follow_lines(now_s);
  recenter();
  update_factors();
}

// Sums the passes of each line, and restarts lines that did not run for a while. After a pause of
// all work, lines that ran before it continue: their first frame may be slow. `before_s`: time of
// the previous frame.
void CostEstimator::collect(std::span<const PassTime> passes, double now_s, double before_s) {
  timed_count_ = 0;
  for (const PassTime& pass : passes) {
    if (!std::isfinite(pass.ms) || pass.ms < 0 || pass.groups == 0) continue;
    Line& line = lines_[pass.cost.value];
    if (!line.in_frame) {
      timed_[timed_count_++] = pass.cost.value;
      line.in_frame = true;
      line.frame_ms = line.frame_measured_ms = 0;
    }
    line.frame_ms += std::max(line.prior.ms(static_cast<double>(pass.groups)), min_calibrated_ms);
    line.frame_measured_ms += pass.ms;
    choice::observe(line.fit, expected_cost(line), line.has_prior, static_cast<double>(pass.groups),
                    pass.ms);
  }
  for (const uint32_t l : timed()) {
    Line& line = lines_[l];
    line.in_frame = false;
    if (line.own.observations == 0 || !is_absent(line.seen_s, now_s) || line.seen_s >= before_s)
      continue;
    line.own.level = std::min(line.own.level, line.usual);
    line.own_factor = std::exp(line.own.level);
    restart(line.own);
  }
}

double CostEstimator::log_error(const Line& line) const {
  return std::log(std::max(line.frame_measured_ms, min_calibrated_ms) /
                  (line.frame_ms * factor(line)));
}

// Only a deviation that all lines share is one of the device: the smallest if all have one sign.
void CostEstimator::follow_device() {
  double total_ms = 0;
  for (const uint32_t l : timed())
    total_ms += lines_[l].frame_ms * factor(lines_[l]);
  double smallest = 0, deviation = 0;
  bool agree = true, any = false;
  for (const uint32_t l : timed()) {
    const Line& line = lines_[l];
    if (line.own.since_restart < even_after || line.own.deviation > even_deviation ||
        line.frame_ms * factor(line) < min_fraction * total_ms)
      continue;
    const double error = log_error(line);
    agree = agree && (!any || error * smallest > 0);
    if (!any || std::abs(error) < std::abs(smallest)) {
      smallest = error;
      deviation = line.own.deviation;
    }
    any = true;
  }
  if (!any) return;
  follow(device_, agree ? smallest : 0, device_gain, deviation);
  device_factor_ = std::exp(device_.level);
}

void CostEstimator::follow_lines(double now_s) {
  for (const uint32_t l : timed()) {
    Line& line = lines_[l];
    const double error = log_error(line);
    if (line.own.observations == 0) line.own.level = unmeasured_ + std::log(line.measured_like);
    follow(line.own, error, own_gain, line.own.deviation);
    line.seen_s = now_s;
    // The first frame may be slow, so it alone does not show what is usual.
    if (line.own.observations == 1)
      line.usual = std::min(line.own.level, unmeasured_ + std::log(line.measured_like)) -
                   std::log(line.uncertainty);
    if (line.own.observations == usual_after) line.usual = line.own.level;
    const double above = line.own.level - line.usual;
    if (line.own.observations > usual_after)
      line.usual += above * (above < 0 ? usual_fall : usual_rise);
  }
}

// Moves the mean deviation of the lines from their usual levels into the factor of the device.
void CostEstimator::recenter() {
  double sum = 0, count = 0;
  for (const uint32_t l : timed())
    if (lines_[l].own.observations > usual_after) {
      sum += lines_[l].own.level - lines_[l].usual;
      ++count;
    }
  if (count == 0) return;
  const double moved = recenter_gain * sum / count;
  device_.level += moved;
  for (const uint32_t l : timed())
    lines_[l].own.level -= moved;
}

void CostEstimator::update_factors() {
  device_factor_ = std::exp(device_.level);
  for (const uint32_t l : timed()) {
    lines_[l].own_factor = std::exp(lines_[l].own.level);
    update_usual_ratio(lines_[l]);
  }
  double sum = 0, count = 0;
  for (const Line& line : lines_)
    if (line.own.observations > 0 && !line.guess) {
      sum += line.own.level - std::log(line.measured_like);
      ++count;
    }
  unmeasured_ = sum / (count + 1); // counts the calibration like one line
  unmeasured_factor_ = std::exp(unmeasured_);
}

void CostEstimator::update_usual_ratio(Line& line) {
  const double above = line.own.level - line.usual;
  line.usual_ratio = above > disturbed ? std::exp(-above) : 1;
}

void CostEstimator::reduce_optimism(CostId id) {
  Line& line = lines_[id.value];
  if (line.own.observations < known_after || line.own.observations >= usual_after) return;
  line.usual += (1 - kept_optimism) * (line.own.level - line.usual);
  update_usual_ratio(line);
}

std::vector<Cost> CostEstimator::calibration() const {
  std::vector<Cost> out;
  std::vector<int> observations; // of the costs in `out`
  for (const Line& line : lines_) {
    if (line.own.observations == 0 && (line.placeholder || !line.has_prior)) continue;
    const AffineCost cost = solve(line.fit, expected_cost(line), line.has_prior);
    const bool measured = line.own.observations > 0;
    out.push_back({line.work, cost.base_ms * 1e3, cost.group_ms * 1e3, line.fit.deviation,
                   measured ? same_device_uncertainty : line.stated});
    observations.push_back(line.own.observations);
  }
  if (out.size() > max_calibrated_costs) keep_most_observed(out, observations);
  std::sort(out.begin(), out.end(), [](const Cost& a, const Cost& b) { return a.work < b.work; });
  return out;
}

} // namespace dermis::choice
