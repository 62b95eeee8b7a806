// Tests the guarantees of docs/choice.md on random devices and scenes. The environment
// variables DERMIS_CHOICE_SEED and DERMIS_CHOICE_SCENARIOS select other scenarios.

#include "tests/framegraph/test_scale.hpp"
#include "tests/passes/choice/judge.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace dermis::choice_test {
namespace {

uint64_t number_from(const char* variable, uint64_t otherwise) {
  const char* text = std::getenv(variable);
  return text != nullptr ? std::strtoull(text, nullptr, 10) : otherwise;
}

uint64_t first_seed() {
  return number_from("DERMIS_CHOICE_SEED", 0);
}

// Returns the scenarios of each disturbance.
uint64_t scenarios() {
  return number_from("DERMIS_CHOICE_SCENARIOS", testing::seeds_to_try(10, 60));
}

// Runs each scenario within three budgets.
void run_all(Disturbance disturbance, const LoopOptions& options, Judgement& sums) {
  for (uint64_t i = 0; i < scenarios(); ++i) {
    const Scenario scenario = make_scenario(disturbance, first_seed() + i);
    for (size_t b = 0; b < scenario.budgets_ms.size(); ++b) {
      const double budget_ms = scenario.budgets_ms[b];
      judge(scenario, budget_ms,
            run_scenario(scenario, budget_ms, scenario.seed * 3 + 1 + b, options), sums);
    }
  }
}

void print(const std::string& name, const Judgement& sums) {
  std::printf("%-13s %4d runs: not recovered %d/%d (p95 %.2f s), often late %d/%d (worst %.2f %%, "
              "%d/%d seconds), not best %d/%d, too many switches %d, switched in calm %d/%d, "
              "excess error p95 %.3f\n",
              name.c_str(), sums.runs, sums.not_recovered, sums.disturbed_runs,
              quantile(sums.recovery_s, 0.95), sums.often_late, sums.steady_runs,
              100 * sums.worst_late_fraction, sums.late_seconds, sums.seconds, sums.not_best,
              sums.wrong_calibrations, sums.too_many_switches, sums.calm_switched, sums.calm_runs,
              quantile(sums.excess_errors, 0.95));
}

Judgement run_all(const LoopOptions& options) {
  Judgement all;
  for (int d = 0; d < static_cast<int>(Disturbance::count); ++d)
    run_all(static_cast<Disturbance>(d), options, all);
  return all;
}

TEST(Controller, RandomDevices_KeepAllGuarantees) {
  const Judgement all = run_all({});
  print("trials", all);
  EXPECT_LE(50 * all.not_recovered, all.disturbed_runs) << "2 %";
  EXPECT_EQ(all.often_late, 0);
  EXPECT_LE(100 * all.late_seconds, all.seconds) << "three late frames in a row";
  EXPECT_LE(100 * all.not_best, all.wrong_calibrations) << "3 s after a wrong calibration";
  EXPECT_EQ(all.long_over, 0);
  EXPECT_EQ(all.too_many_switches, 0) << "more than T + 1 in T seconds";
  EXPECT_LE(100 * all.calm_switched, 8 * all.calm_runs);
  EXPECT_LT(quantile(all.excess_errors, 0.95), 0.25);
}

// Judges one scenario within its three budgets.
Judgement judge_scenario(Disturbance disturbance, uint64_t seed) {
  const Scenario scenario = make_scenario(disturbance, seed);
  Judgement sums;
  for (size_t b = 0; b < scenario.budgets_ms.size(); ++b)
    judge(scenario, scenario.budgets_ms[b],
          run_scenario(scenario, scenario.budgets_ms[b], scenario.seed * 3 + 1 + b, {}), sums);
  return sums;
}

// Several long frames in a row make a configuration leave and another one look fast. The switch to
// one that takes too long must not use the last token: it would stay for two seconds.
TEST(Controller, LongFramesInARow_KeepNothingLate) {
  const Judgement sums = judge_scenario(Disturbance::thermal, 53048);
  EXPECT_EQ(sums.often_late, 0);
  EXPECT_LT(sums.worst_late_fraction, 0.045);
}

// Costs per dispatch and per group are wrong by different factors. What was learned with few tiles
// then makes a configuration look as if it fits, and running it makes it look slower again.
TEST(Controller, WrongForecast_IsNotTriedAgainAndAgain) {
  for (const auto& [disturbance, seed] :
       {std::pair(Disturbance::cut, 170119), std::pair(Disturbance::cut, 170039),
        std::pair(Disturbance::mixed, 130095)}) {
    const Judgement sums = judge_scenario(disturbance, static_cast<uint64_t>(seed));
    EXPECT_EQ(sums.often_late, 0) << seed;
    EXPECT_LT(sums.worst_late_fraction, 0.03) << seed;
  }
}

// Without trials, unknown and disturbed configurations are not found again.
TEST(Controller, TrialsRestricted_StaysWithinTheBudget) {
  for (const choice::Trials trials : {choice::Trials::cuts_only, choice::Trials::off}) {
    Judgement all;
    for (const Disturbance disturbance :
         {Disturbance::calibration, Disturbance::cut, Disturbance::long_pass})
      run_all(disturbance, {.trials = trials}, all);
    print(trials == choice::Trials::off ? "no trials" : "cuts only", all);
    EXPECT_EQ(all.often_late, 0);
    EXPECT_LE(100 * all.late_seconds, all.seconds);
    EXPECT_EQ(all.long_over, 0);
    EXPECT_EQ(all.too_many_switches, 0);
  }
}

// With the same noise, a larger budget gives no fewer samples and no larger error, in the last 20 s
// of a minute.
TEST(Controller, LargerBudget_NeverGivesLess) {
  constexpr int frames = 3600, judged = 1200, budgets = 8;
  for (uint64_t i = 0; i < std::max<uint64_t>(4, scenarios() / 2); ++i) {
    const Scenario scenario =
        make_scenario(i % 2 == 0 ? Disturbance::calibration : Disturbance::none, first_seed() + i);
    double least_rmse = 1e9;
    std::vector<double> most_units(scenario.configurations.size(), 0);
    for (int b = 0; b < budgets; ++b) {
      const double budget_ms =
          scenario.budgets_ms[0] *
          std::pow(1.5 * scenario.budgets_ms[2] / scenario.budgets_ms[0], b / double(budgets - 1));
      const std::vector<RunFrame> run = run_scenario(scenario, budget_ms, 5, {}, frames);
      double rmse = 0, units = 0;
      std::vector<int> counts(scenario.configurations.size(), 0);
      for (const RunFrame& frame : std::span(run).last(judged)) {
        rmse += rmse_of(scenario.configurations[frame.configuration], frame.units, frame.tiles) /
                judged;
        units += frame.units / judged;
        ++counts[frame.configuration];
      }
      EXPECT_LE(rmse, 1.02 * least_rmse) << "scenario " << i << ", budget " << b;
      least_rmse = std::min(least_rmse, rmse);
      const auto usual =
          static_cast<size_t>(std::max_element(counts.begin(), counts.end()) - counts.begin());
      if (scenario.configurations[usual].samples < 0 || counts[usual] < 0.96 * judged) continue;
      EXPECT_GE(units, most_units[usual] - 0.02 * requested_units(scenario.tiles))
          << "scenario " << i << ", budget " << b;
      most_units[usual] = std::max(most_units[usual], units);
    }
  }
}

TEST(Controller, Deterministic_NoiseChangesNothing) {
  for (uint64_t i = 0; i < std::max<uint64_t>(4, scenarios() / 2); ++i) {
    const Scenario scenario = make_scenario(Disturbance::mixed, first_seed() + i);
    const LoopOptions options{.deterministic = true};
    const auto a = run_scenario(scenario, scenario.budgets_ms[1], 1, options, 3000);
    const auto b = run_scenario(scenario, scenario.budgets_ms[1], 2, options, 3000);
    for (size_t t = 0; t < a.size(); ++t) {
      ASSERT_EQ(a[t].configuration, b[t].configuration) << "scenario " << i << ", frame " << t;
      ASSERT_EQ(a[t].units, b[t].units) << "scenario " << i << ", frame " << t;
    }
  }
}

// A percentile of 0.8 fills the budget more than one of 0.99.
TEST(Controller, Percentile_SetsTheFractionOfLateFrames) {
  Scenario scenario = make_scenario(Disturbance::none, first_seed() + 2);
  scenario.strange_frames = false;
  std::erase_if(scenario.configurations,
                [](const SimulatedConfiguration& one) { return one.samples < 0; });
  ASSERT_EQ(scenario.configurations.size(), 1u);
  const SimulatedConfiguration& only = scenario.configurations.front();
  const double all_ms =
      true_ms(scenario, static_cast<uint32_t>(only.samples), requested_units(scenario.tiles), 0);
  double fixed_ms = 0;
  for (const uint32_t pass : only.passes)
    fixed_ms += true_ms(scenario, pass, groups_of(scenario, pass, scenario.tiles), 0);
  const double budget_ms = fixed_ms + 0.5 * all_ms; // samples fill it
  for (const double percentile : {0.8, 0.95, 0.99}) {
    LoopOptions options;
    options.percentile = percentile;
    int late = 0;
    const auto run = run_scenario(scenario, budget_ms, 3, options);
    for (const RunFrame& frame : std::span(run).last(4200))
      late += frame.ms > budget_ms ? 1 : 0;
    EXPECT_LE(late / 4200.0, 1 - percentile) << percentile;
    EXPECT_GE(late / 4200.0, 0.15 * (1 - percentile)) << percentile;
  }
}

} // namespace
} // namespace dermis::choice_test
