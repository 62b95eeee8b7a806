#include "integration/tools/command/bench/choice/budget_judge.hpp"

#include "integration/tools/command/statistics.hpp"
#include "passes/choice/budget_controller.hpp"
#include "passes/choice/time_margin.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <span>
#include <utility>

namespace dermis::tools {
namespace {

// A configuration with less than this fraction of the error without scattering scatters.
constexpr double scatters_below = 0.75;
// fraction of frames in which a single technique must keep the budget
constexpr double within = 0.99;

std::span<const RunFrame> judged_frames(const SceneRun& run) {
  return std::span(run.frames).subspan(unjudged_frames);
}

} // namespace

double Single::calibrated_at(double fraction) const {
  std::vector<double> sorted = calibrated_ms;
  std::sort(sorted.begin(), sorted.end());
  const auto rank = static_cast<size_t>(std::ceil(fraction * double(sorted.size())));
  return sorted[std::clamp<size_t>(rank, 1, sorted.size()) - 1];
}

Single single_of(const SceneRun& run, std::vector<NamedValue> set) {
  Single single{std::move(set), {}, pooled_rmse(run)};
  for (const RunFrame& frame : judged_frames(run))
    single.calibrated_ms.push_back(frame.choice.calibrated_ms);
  return single;
}

double controller_room() {
  choice::Forecast forecast;
  forecast.time.pessimistic_ms = 1;
  forecast.margin = choice::calibrated_margin;
  return 1 / needed_budget_ms(forecast, 0);
}

const Single* best_within(const std::vector<Single>& singles, double budget_ms) {
  const Single* best = nullptr;
  for (const Single& one : singles)
    if (one.calibrated_at(within) <= controller_room() * budget_ms &&
        (best == nullptr || one.rmse < best->rmse))
      best = &one;
  return best;
}

double budget_of(const Single& single) {
  return single.calibrated_at(within);
}

const Single& cheapest_of(const std::vector<Single>& singles) {
  return *std::min_element(singles.begin(), singles.end(), [](const Single& a, const Single& b) {
    return a.calibrated_at(within) < b.calibrated_at(within);
  });
}

const Single* cheapest_scattering(const std::vector<Single>& singles) {
  const double most = scatters_below * cheapest_of(singles).rmse;
  const Single* cheapest = nullptr;
  for (const Single& one : singles)
    if (one.rmse < most &&
        (cheapest == nullptr || one.calibrated_at(within) < cheapest->calibrated_at(within)))
      cheapest = &one;
  return cheapest;
}

bool none_scatters_within(const std::vector<Single>& singles, double budget_ms) {
  const Single* best = best_within(singles, budget_ms);
  return cheapest_scattering(singles) != nullptr &&
         (best == nullptr || best->rmse >= scatters_below * cheapest_of(singles).rmse);
}

double budget_at(const std::vector<Single>& singles, double fraction) {
  double floor_ms = singles.front().calibrated_at(within);
  for (const Single& single : singles)
    floor_ms = std::min(floor_ms, single.calibrated_at(within));
  const auto best =
      std::min_element(singles.begin(), singles.end(),
                       [](const Single& a, const Single& b) { return a.rmse < b.rmse; });
  return floor_ms + fraction * (best->calibrated_at(within) - floor_ms);
}

TimedFigures judge_times(const SceneRun& run, double budget_ms) {
  TimedFigures out;
  std::vector<double> times;
  for (const RunFrame& frame : judged_frames(run))
    times.push_back(frame.choice.measured_ms);
  for (const double ms : times) {
    out.mean_ms += ms / double(times.size());
    out.over += ms > measured_tolerance * budget_ms ? 1.0 / double(times.size()) : 0;
  }
  out.p95_ms = quantile(times, 0.95);
  out.switches = double(run.frames.back().choice.switches);
  return out;
}

TimedFigures median_of(const std::vector<TimedFigures>& runs) {
  if (runs.empty()) return {};
  const auto middle = [&](double TimedFigures::*figure) {
    std::vector<double> values;
    for (const TimedFigures& run : runs)
      values.push_back(run.*figure);
    return median(values);
  };
  return {middle(&TimedFigures::mean_ms), middle(&TimedFigures::p95_ms),
          middle(&TimedFigures::over), middle(&TimedFigures::switches)};
}

std::optional<double> BudgetRow::ratio() const {
  if (!single_rmse || !(*single_rmse > 0) || unscattered_rmse) return std::nullopt;
  return rmse / *single_rmse;
}

RatioSummary summarise_ratios(const std::vector<const BudgetRow*>& rows) {
  RatioSummary out;
  double logs = 0;
  for (const BudgetRow* row : rows) {
    const std::optional<double> ratio = row->ratio();
    if (!ratio || !(*ratio > 0)) continue;
    ++out.scenes;
    logs += std::log(*ratio);
    if (*ratio > out.worst) {
      out.worst = *ratio;
      out.worst_scene = row->scene;
    }
  }
  if (out.scenes > 0) out.mean = std::exp(logs / double(out.scenes));
  return out;
}

std::string chosen_of(const SceneRun& run) {
  std::map<std::string, size_t> count;
  const auto frames = judged_frames(run);
  for (const RunFrame& frame : frames)
    ++count[frame.choice.configuration];
  std::vector<std::pair<std::string, size_t>> sorted(count.begin(), count.end());
  std::ranges::stable_sort(sorted, std::greater<>(), &std::pair<std::string, size_t>::second);
  std::string text;
  for (const auto& [name, frames_of_name] : sorted)
    text += fmt::format("{}{} {:.0f} %", text.empty() ? "" : ", ", name,
                        100 * double(frames_of_name) / double(frames.size()));
  return text;
}

double fraction_over_model(const SceneRun& run, double budget_ms) {
  double over = 0;
  const auto frames = judged_frames(run);
  for (const RunFrame& frame : frames)
    over +=
        frame.choice.calibrated_ms > model_tolerance * budget_ms ? 1 / double(frames.size()) : 0;
  return over;
}

double pooled_rmse(const SceneRun& run) {
  double sum = 0;
  uint32_t count = 0;
  for (const RunFrame& frame : judged_frames(run))
    if (frame.rmse) {
      sum += *frame.rmse * *frame.rmse;
      ++count;
    }
  return count > 0 ? std::sqrt(sum / count) : 0;
}

} // namespace dermis::tools
