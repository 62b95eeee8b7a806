#pragma once
// What dermis bench budget says of runs: how well their frames kept to a budget, and which single technique
// would have.

#include "integration/tools/command/bench/choice/scene_run.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace dermis::tools {

constexpr uint32_t unjudged_frames = 10;                            // of each run, its first
constexpr double measured_tolerance = 1.15, model_tolerance = 1.05; // of the budget: over it beyond that

// One outcome alone over the whole scene.
struct Single {
  std::vector<NamedValue> set; // as JSON
  std::vector<double> metered_ms;
  double rmse = 0;

  double metered_at(double fraction) const; // nearest rank
};

Single single_of(const SceneRun& run, std::vector<NamedValue> set);

// The least error among those whose meter keeps to the budget in 99 % of the frames; null: none does.
const Single* best_within(const std::vector<Single>& singles, double budget_ms);

// Budget of a share of the way from the cheapest outcome to the best, in milliseconds. Not of none.
double budget_at(const std::vector<Single>& singles, double fraction);

// By timestamps, of the judged frames.
struct TimedFigures {
  double mean_ms = 0, p95_ms = 0, over = 0; // over: share of the frames
  double switches = 0;
};

TimedFigures judge_times(const SceneRun& run, double budget_ms);

// Each figure's median, the larger of the middle two. Not of none.
TimedFigures median_of(const std::vector<TimedFigures>& runs);

// A budget of a scene: what its runs were like.
struct BudgetRow {
  std::string scene;
  double x = 0, budget_ms = 0;
  double over_model = 0, rmse = 0;        // of the deterministic run
  std::optional<double> single_rmse = {}; // of the best single outcome that keeps the budget; none does: none
  std::string single = {};                // its settings
  std::vector<TimedFigures> timed = {};   // a run each
};

double fraction_over_model(const SceneRun& run, double budget_ms);

// Root of the mean square over the judged frames that were compared with the truth.
double pooled_rmse(const SceneRun& run);

} // namespace dermis::tools
