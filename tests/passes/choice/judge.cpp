#include "tests/passes/choice/judge.hpp"

#include <algorithm>
#include <cmath>

namespace dermis::choice_test {
namespace {

// Fraction of the budget that the oracle leaves free, for hysteresis and margins.
constexpr double band = 0.10;
// A frame is good with an error within the first factor of the oracle's, and 95 % of the frames
// within the second factor of the budget.
constexpr double good_rmse = 1.02, good_budget = 1.05;
constexpr int good_frames = 45; // in a row
constexpr double recovery_s = 3, learning_s = 3;
constexpr double never_s = 99;
constexpr double late_fraction = 0.05; // 1 - percentile
constexpr double first_calm_s = 20;
// 4 % of normally distributed frames are above; 1 % more are strange.
constexpr double p95_deviations = 1.75;

struct FrameTime {
  double mean_ms = 0, p95_ms = 0;
};

FrameTime time_of(const Scenario& scenario, const SimulatedConfiguration& configuration,
                  double tiles, double units, int frame) {
  double sum = 0, variance = 0;
  const auto add = [&](uint32_t pass, double groups) {
    const double ms = true_ms(scenario, pass, groups, frame);
    sum += ms;
    variance += std::pow(ms * scenario.passes[pass].noise, 2);
  };
  for (const uint32_t pass : configuration.passes)
    add(pass, groups_of(scenario, pass, tiles));
  if (configuration.samples >= 0 && units > 0)
    add(static_cast<uint32_t>(configuration.samples), units);
  const double deviation =
      std::sqrt(variance / (sum * sum) + scenario.frame_noise * scenario.frame_noise);
  return {sum, sum * std::exp(p95_deviations * deviation)};
}

// Returns the units of samples that fit; negative if the configuration does not fit without any.
double units_within(const Scenario& scenario, const SimulatedConfiguration& configuration,
                    double tiles, double budget_ms, int frame) {
  const auto fits = [&](double units) {
    return time_of(scenario, configuration, tiles, units, frame).p95_ms <= budget_ms;
  };
  if (!fits(0)) return -1;
  if (configuration.samples < 0) return 0;
  double low = 0, high = requested_units(tiles);
  if (fits(high)) return high;
  for (int i = 0; i < 24; ++i) {
    const double middle = (low + high) / 2;
    (fits(middle) ? low : high) = middle;
  }
  return low;
}

// A run to be judged.
class Run {
public:
  Run(const Scenario& of, double budget, std::span<const RunFrame> done)
      : scenario(of), budget_ms(budget), frames_(done) {}

  int count() const { return static_cast<int>(frames_.size()); }
  const RunFrame& at(int t) const { return frames_[static_cast<size_t>(t)]; }
  bool late(int t) const { return at(t).ms > budget_ms; }
  bool can_fit(int t) const { return best(t, 0).fits; }

  bool good(int t) const {
    const RunFrame& frame = at(t);
    const Best& known = best(t, 1);
    if (!known.fits) return frame.configuration == known.configuration || can_fit(t);
    const SimulatedConfiguration& one = scenario.configurations[frame.configuration];
    return rmse_of(one, frame.units, frame.tiles) <= good_rmse * known.rmse &&
           time_of(scenario, one, frame.tiles, frame.units, t).p95_ms <= good_budget * budget_ms;
  }

  const Scenario& scenario;
  const double budget_ms;

private:
  // Returns the best choice within the budget (`banded` 0) or within the budget less the band (1).
  // Most frames are like the one before.
  const Best& best(int t, size_t banded) const {
    Cached& cached = cached_[banded];
    const double tiles = at(t).tiles, clock = scenario.clock[static_cast<size_t>(t)];
    const bool plain = scenario.factors[static_cast<size_t>(t)].empty();
    if (!plain || !cached.plain || cached.tiles != tiles || cached.clock != clock)
      cached = {best_choice(scenario, budget_ms * (banded != 0 ? 1 - band : 1), tiles, t), tiles,
                clock, plain};
    return cached.best;
  }

  struct Cached {
    Best best;
    double tiles = 0, clock = 0;
    bool plain = false; // without factors of single passes
  };
  std::span<const RunFrame> frames_;
  mutable std::array<Cached, 2> cached_;
};

// Returns the seconds from frame `from` until the start of `good_frames` good frames.
double seconds_until_good(const Run& run, int from) {
  int good = 0;
  for (int t = from; t < std::min(run.count(), from + 1800); ++t) {
    good = run.good(t) ? good + 1 : 0;
    if (good >= good_frames) return (t - good_frames + 1 - from) * frame_seconds;
  }
  return never_s;
}

bool calm(const Scenario& scenario) {
  return scenario.disturbance == Disturbance::none ||
         scenario.disturbance == Disturbance::calibration;
}

void judge_recovery(const Run& run, Judgement& sums) {
  const int end = run.scenario.disturbed_until;
  const double seconds = seconds_until_good(run, end);
  // No pass that runs shows the end of a disturbance of one technique, so it may last as long
  // again.
  const double allowed = run.scenario.disturbance == Disturbance::long_pass
                             ? std::max(recovery_s, (end - first_disturbed) * frame_seconds + 1)
                             : recovery_s;
  ++sums.disturbed_runs;
  sums.not_recovered += seconds > allowed ? 1 : 0;
  sums.recovery_s.push_back(seconds);
}

void judge_lateness(const Run& run, Judgement& sums) {
  const Scenario& scenario = run.scenario;
  if (!best_choice(scenario, run.budget_ms * (1 - band), scenario.tiles, 0).fits) return;
  int late = 0, frames = 0;
  const auto count = [&](int from, int until) {
    for (int t = from, row = 0; t < until; ++t) {
      row = run.late(t) ? row + 1 : 0;
      late += run.late(t) ? 1 : 0;
      ++frames;
      sums.late_seconds += row == 3 ? 1 : 0;
      sums.seconds += (t - from) % 60 == 59 ? 1 : 0;
    }
  };
  count(1200, first_disturbed);
  count(3600, run.count());
  const double fraction = double(late) / frames;
  ++sums.steady_runs;
  sums.often_late += fraction > late_fraction ? 1 : 0;
  sums.worst_late_fraction = std::max(sums.worst_late_fraction, fraction);
}

void judge_learning(const Run& run, Judgement& sums) {
  if (run.scenario.disturbance != Disturbance::calibration && run.scenario.seed % 2 == 0) return;
  double over_s = 0, not_best_s = 0;
  for (int t = 0; t < first_disturbed; ++t) {
    if (run.late(t) && run.can_fit(t)) over_s += (run.at(t).ms - run.budget_ms) * 1e-3;
    if (!run.good(t)) not_best_s += frame_seconds;
  }
  ++sums.wrong_calibrations;
  sums.not_best += not_best_s > learning_s ? 1 : 0;
  sums.long_over += over_s > 2 ? 1 : 0;
}

void judge_switches(const Run& run, Judgement& sums) {
  std::vector<double> at;
  for (int t = 1; t < run.count(); ++t)
    if (run.at(t).configuration != run.at(t - 1).configuration) at.push_back(t * frame_seconds);
  bool fast = false;
  for (size_t i = 0; i < at.size(); ++i)
    for (size_t j = i + 1; j < at.size(); ++j)
      fast = fast ||
             (at[i] > learning_s + 0.1 && double(j - i + 1) > std::max(1.0, at[j] - at[i]) + 1.05);
  sums.too_many_switches += fast ? 1 : 0;
  if (!calm(run.scenario)) return;
  ++sums.calm_runs;
  sums.calm_switched += !at.empty() && at.back() > first_calm_s ? 1 : 0;
}

void judge_error(const Run& run, Judgement& sums) {
  double sum = 0, count = 0;
  for (int t = run.count() - 1200; t < run.count(); t += 60, ++count) {
    const RunFrame& frame = run.at(t);
    sum += rmse_of(run.scenario.configurations[frame.configuration], frame.units, frame.tiles) /
               best_choice(run.scenario, run.budget_ms, frame.tiles, t).rmse -
           1;
  }
  sums.excess_errors.push_back(sum / count);
}

} // namespace

double rmse_of(const SimulatedConfiguration& configuration, double units, double tiles) {
  if (configuration.samples < 0) return configuration.rmse;
  const double none = std::pow(configuration.unsampled_rmse, 2);
  return std::sqrt(none + std::min(1.0, units / requested_units(tiles)) *
                              (std::pow(configuration.rmse, 2) - none));
}

Best best_choice(const Scenario& scenario, double budget_ms, double tiles, int frame) {
  Best best, cheapest;
  double least_ms = 0;
  for (uint32_t i = 0; i < scenario.configurations.size(); ++i) {
    const SimulatedConfiguration& one = scenario.configurations[i];
    const double ms = time_of(scenario, one, tiles, 0, frame).mean_ms;
    if (i == 0 || ms < least_ms) {
      least_ms = ms;
      cheapest = {i, one.unsampled_rmse, false};
    }
    const double units = units_within(scenario, one, tiles, budget_ms, frame);
    if (units < 0) continue;
    const double rmse = rmse_of(one, units, tiles);
    if (!best.fits || rmse < best.rmse) best = {i, rmse, true};
  }
  return best.fits ? best : cheapest;
}

void judge(const Scenario& scenario, double budget_ms, std::span<const RunFrame> frames,
           Judgement& sums) {
  const Run run(scenario, budget_ms, frames);
  ++sums.runs;
  if (!calm(scenario)) judge_recovery(run, sums);
  judge_lateness(run, sums);
  judge_learning(run, sums);
  judge_switches(run, sums);
  judge_error(run, sums);
}

double quantile(std::vector<double> values, double fraction) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[std::min(values.size() - 1, static_cast<size_t>(fraction * double(values.size())))];
}

} // namespace dermis::choice_test
