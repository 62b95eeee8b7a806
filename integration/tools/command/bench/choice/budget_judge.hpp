#pragma once
// Judges runs of dermis bench budget: how well their frames kept the budget, and which single
// technique would have.

#include "integration/tools/command/bench/choice/scene_run.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace dermis::tools {

constexpr uint32_t unjudged_frames = 10; // first frames of each run
// factors of the budget above which a frame is over the budget
constexpr double measured_tolerance = 1.15, model_tolerance = 1.05;

// One configuration used for the whole scene.
struct Single {
  std::vector<NamedValue> set; // values as JSON
  std::vector<double> calibrated_ms;
  double rmse = 0;

  double calibrated_at(double fraction) const; // percentile by nearest rank
};

Single single_of(const SceneRun& run, std::vector<NamedValue> set);

// Returns the fraction of the budget within which the controller enters a configuration, with the
// margin of calibrated times.
double controller_room();
// Returns the single with the least error of those whose calibrated time stays within this fraction
// of the budget in 99 % of the frames, or null.
const Single* best_within(const std::vector<Single>& singles, double budget_ms);

// Interpolates between the cheapest (0) and the best configuration (1), milliseconds. `singles`
// must not be empty.
double budget_at(const std::vector<Single>& singles, double fraction);

// Figures from timestamps of the judged frames.
struct TimedFigures {
  double mean_ms = 0, p95_ms = 0, over = 0; // over: fraction of the frames
  double switches = 0;
};

TimedFigures judge_times(const SceneRun& run, double budget_ms);

// Returns the median of each figure, the larger of the middle two; 0 without runs.
TimedFigures median_of(const std::vector<TimedFigures>& runs);

// Results for one budget of a scene.
struct BudgetRow {
  std::string scene;
  double x = 0, budget_ms = 0;
  double over_model = 0, rmse = 0; // of the deterministic run
  std::string chosen = {};         // chosen_of(the deterministic run)
  // of the best single configuration that keeps the budget; not set if there is none
  std::optional<double> single_rmse = {};
  std::string single = {}; // settings of that configuration
  // error without scattering; set if none_scatters_within the budget
  std::optional<double> unscattered_rmse = {};
  std::vector<TimedFigures> timed = {}; // one per timed run; none for still scenes
  std::string half = {};                // of the family; "": a scene of configs/scenes

  // Returns the ratio to the RMSE of the best single configuration, if there is one that scatters.
  std::optional<double> ratio() const;
};

// Errors relative to the best single configuration, over scenes.
struct RatioSummary {
  size_t scenes = 0;
  double mean = 0, worst = 0; // mean: geometric
  std::string worst_scene = {};
};
// Summarises the rows with a ratio.
RatioSummary summarise_ratios(const std::vector<const BudgetRow*>& rows);

// Returns the calibrated time that a budget must have for a configuration, ms.
double budget_of(const Single& single);

const Single& cheapest_of(const std::vector<Single>& singles);
// Returns the cheapest configuration whose error is clearly below that of cheapest_of(), which
// scatters nothing. Null if there is none.
const Single* cheapest_scattering(const std::vector<Single>& singles);
// Returns whether a configuration scatters, but best_within() the budget finds none that does.
bool none_scatters_within(const std::vector<Single>& singles, double budget_ms);

// Returns the configurations of the judged frames and the fraction of frames of each, the most
// frequent first: "technique=sap variant=base 75 %, technique=partial 25 %".
std::string chosen_of(const SceneRun& run);

double fraction_over_model(const SceneRun& run, double budget_ms);

// Returns the root of the mean square error over the judged frames that were compared with the
// reference.
double pooled_rmse(const SceneRun& run);

} // namespace dermis::tools
