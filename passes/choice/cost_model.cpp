#include "passes/choice/cost_model.hpp"

#include <algorithm>
#include <cmath>

namespace dermis::choice {
namespace {

// Chosen on recorded timings of the software driver, whose single frames deviate by up to 3 times.
constexpr double unit_groups = 1024; // scales both coefficients to similar size
constexpr double time_memory = 0.96; // weight of the past at each new frame: a memory of 25 frames
constexpr double prior_weight = 0.5; // weight of the calibration, in frames
// weight without a calibration, which only keeps the equations regular
constexpr double no_prior_weight = 1e-3;
// residuals beyond this many typical residuals count less (Huber 1964)
constexpr double outlier = 2.0;
constexpr uint64_t settled = 4;      // observations before a residual can be an outlier
constexpr double first_spread = 0.3; // assumed before the first observation
constexpr double spread_memory = 0.9;
constexpr double scale_memory = 0.995; // over all observations of all lines
constexpr double tiny_ms = 1e-6;       // 1 ns: timestamps are no finer

double units(uint64_t groups) {
  return static_cast<double>(groups) / unit_groups;
}

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

} // namespace

CostModel::CostModel(std::vector<Cost> calibration) {
  for (Cost& cost : calibration) {
    Line& line = lines_.emplace_back();
    line.work = std::move(cost.work);
    line.prior[0] = cost.base_us * 1e-3;
    line.prior[1] = cost.group_us * 1e-3 * unit_groups;
    line.spread = cost.spread;
    line.has_prior = true;
  }
}

CostId CostModel::add(std::string_view work) {
  for (uint32_t i = 0; i < lines_.size(); ++i)
    if (lines_[i].work == work) return {i};
  Line line;
  line.work = work;
  line.spread = first_spread;
  if (const Line* like = placeholder_for(work)) {
    const Coefficients at =
        like->has_prior ? Coefficients{like->prior[0], like->prior[1]} : solve(*like);
    line.prior[0] = at.base_ms;
    line.prior[1] = at.unit_ms;
    line.has_prior = line.placeholder = true;
    line.guess = like->guess || words_alike(like->work, work) == 0;
  }
  lines_.push_back(std::move(line));
  return {static_cast<uint32_t>(lines_.size() - 1)};
}

const CostModel::Line* CostModel::placeholder_for(std::string_view work) const {
  const Line* best = nullptr;
  size_t maximum = 0;
  for (const Line& line : lines_) {
    if (!line.has_prior && line.observations == 0) continue;
    const size_t alike = words_alike(line.work, work);
    if (alike > maximum) {
      maximum = alike;
      best = &line;
    }
  }
  if (best != nullptr) return best;
  const auto costs_less = [this](const Line& a, const Line& b) {
    return solve(a).unit_ms < solve(b).unit_ms;
  };
  const auto costliest = std::max_element(lines_.begin(), lines_.end(), costs_less);
  return costliest != lines_.end() ? &*costliest : nullptr;
}

double CostModel::device_scale() const {
  return scale_weight_ > 0 ? std::exp(scale_sum_ / scale_weight_) : 1.0;
}

// Weighted least squares with the calibration as prior; coefficients are not negative.
CostModel::Coefficients CostModel::solve(const Line& line) const {
  const double scale = device_scale();
  const double prior[2] = {line.prior[0] * scale, line.prior[1] * scale};
  if (line.observations == 0) return {prior[0], prior[1]};
  const double pull = line.has_prior ? prior_weight : no_prior_weight;
  const double m00 = line.moments[0] + pull, m01 = line.moments[1], m11 = line.moments[2] + pull;
  const double t0 = line.targets[0] + pull * prior[0], t1 = line.targets[1] + pull * prior[1];
  const double determinant = m00 * m11 - m01 * m01; // > 0: Cauchy-Schwarz and the prior's weight
  Coefficients out{(t0 * m11 - t1 * m01) / determinant, (t1 * m00 - t0 * m01) / determinant};
  if (out.base_ms < 0) out = {0, std::max(0.0, t1 / m11)};
  if (out.unit_ms < 0) out = {std::max(0.0, t0 / m00), 0};
  return out;
}

Estimate CostModel::estimate(CostId id, uint64_t groups) const {
  const Line& line = lines_[id.value];
  const Coefficients at = solve(line);
  const double ms = at.base_ms + at.unit_ms * units(groups);
  return {ms, ms * line.spread, line.observations > 0};
}

double CostModel::calibrated_ms(CostId id, uint64_t groups) const {
  const Line& line = lines_[id.value];
  return line.prior[0] + line.prior[1] * units(groups);
}

void CostModel::observe(CostId id, uint64_t groups, double ms) {
  if (!std::isfinite(ms) || ms < 0) return;
  Line& line = lines_[id.value];
  const double x = units(groups);
  double weight = 1;
  if (line.observations > 0) {
    const Coefficients at = solve(line);
    const double expected = at.base_ms + at.unit_ms * x;
    const double off = std::abs(ms - expected) / std::max(expected, tiny_ms);
    if (line.observations >= settled && off > outlier * line.spread)
      weight = outlier * line.spread / off;
    line.spread = spread_memory * line.spread + (1 - spread_memory) * std::min(off, 1.0);
  }
  const double calibrated = line.prior[0] + line.prior[1] * x;
  if (line.has_prior && !line.guess && calibrated > tiny_ms && ms > tiny_ms) {
    scale_sum_ = scale_memory * scale_sum_ + calibrated * std::log(ms / calibrated);
    scale_weight_ = scale_memory * scale_weight_ + calibrated; // long passes are more reliable
  }
  const double x_power[3] = {1, x, x * x};
  for (size_t i = 0; i < 3; ++i)
    line.moments[i] = time_memory * line.moments[i] + weight * x_power[i];
  for (size_t i = 0; i < 2; ++i)
    line.targets[i] = time_memory * line.targets[i] + weight * ms * x_power[i];
  ++line.observations;
}

std::vector<Cost> CostModel::calibration() const {
  std::vector<Cost> out;
  for (const Line& line : lines_) {
    if (line.observations == 0 && (line.placeholder || !line.has_prior)) continue;
    const Coefficients at = solve(line);
    out.push_back({line.work, at.base_ms * 1e3, at.unit_ms * 1e3 / unit_groups, line.spread});
  }
  std::sort(out.begin(), out.end(), [](const Cost& a, const Cost& b) { return a.work < b.work; });
  return out;
}

} // namespace dermis::choice
