#pragma once
// What dermis bench budget says of runs: how well their frames kept to a budget, and which single technique
// would have.

#include "integration/command/bench/choice/scene_run.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace dermis::tools {

constexpr uint32_t warm_up = 10;                                    // frames that are not judged
constexpr double measured_tolerance = 1.15, meter_tolerance = 1.05; // of the budget: over it beyond that
constexpr double within = 0.99; // share of frames whose meter a single technique must keep

// One outcome alone over the whole scene.
struct Single {
  std::vector<NamedValue> set; // as JSON
  std::vector<double> metered_ms;
  double rmse = 0;

  double metered_at(double share) const; // nearest rank
};

// Null: none, or none keeps to the budget.
Single single_of(const SceneRun& run, std::vector<NamedValue> set);
const Single* best_within(const std::vector<Single>& singles, double budget_ms);

// Budget of a share of the way from the cheapest outcome to the best, in milliseconds. Not of none.
double budget_at(const std::vector<Single>& singles, double share);

// By timestamps, of the judged frames.
struct TimedFigures {
  double mean_ms = 0, p95_ms = 0, over = 0; // over: share of the frames
  double switches = 0;
};

TimedFigures judge_times(const SceneRun& run, double budget_ms);

// Each figure's median. Not of none.
TimedFigures median_of(const std::vector<TimedFigures>& runs);

double share_over_meter(const SceneRun& run, double budget_ms);

// Root of the mean square over the judged frames that were compared with the truth.
double pooled_rmse(const SceneRun& run);

} // namespace dermis::tools
