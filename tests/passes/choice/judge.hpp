#pragma once
// Judges runs of a controller against an oracle that knows the true times.

#include "tests/passes/choice/control_loop.hpp"

#include <span>

namespace dermis::choice_test {

// Returns the mean square interpolated between no samples and all requested samples.
double rmse_of(const SimulatedConfiguration& configuration, double units, double tiles);

// The best choice for someone who knows the true times.
struct Best {
  uint32_t configuration = 0;
  double rmse = 0;
  bool fits = false; // otherwise the configuration is the cheapest
};
Best best_choice(const Scenario& scenario, double budget_ms, double tiles, int frame);

// Counts over runs. Fractions are of runs, unless stated otherwise.
struct Judgement {
  int runs = 0;
  int disturbed_runs = 0, not_recovered = 0;
  int steady_runs = 0, often_late = 0; // late: over the budget
  double worst_late_fraction = 0;      // of the frames of a steady run
  int seconds = 0, late_seconds = 0;   // late_seconds: with three late frames in a row
  int wrong_calibrations = 0, not_best = 0, long_over = 0;
  int too_many_switches = 0;
  int calm_runs = 0, calm_switched = 0;
  std::vector<double> recovery_s;    // of disturbed runs; 99: never
  std::vector<double> excess_errors; // over the oracle's, in the last 20 s
};

// Adds a run of a whole scenario.
void judge(const Scenario& scenario, double budget_ms, std::span<const RunFrame> run,
           Judgement& sums);

// Returns the quantile of the values; 0 without values.
double quantile(std::vector<double> values, double fraction);

} // namespace dermis::choice_test
