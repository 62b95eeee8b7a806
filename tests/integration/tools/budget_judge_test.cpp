// Tests how `dermis bench budget` evaluates runs, on invented runs.

#include "integration/tools/command/bench/choice/budget_judge.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace dermis::tools {
namespace {

constexpr double budget_ms = 10;

// Returns uncounted frames of one second each, followed by frames that take `ms`.
SceneRun run_of(const std::vector<double>& ms) {
  SceneRun run;
  for (uint32_t i = 0; i < unjudged_frames + ms.size(); ++i) {
    RunFrame& frame = run.frames.emplace_back();
    frame.choice.measured_ms = frame.choice.calibrated_ms =
        i < unjudged_frames ? 1000 : ms[i - unjudged_frames];
    if (i < unjudged_frames) frame.rmse = 1.0;
  }
  return run;
}

Single single(double calibrated_ms, double rmse) {
  return {{}, {calibrated_ms}, rmse};
}

TEST(BudgetJudge, CountsFramesOverTheToleranceExceptTheFirst) {
  const SceneRun run = run_of({10, 11, 11.4, 11.6});
  EXPECT_DOUBLE_EQ(judge_times(run, budget_ms).over, 0.25);
  EXPECT_DOUBLE_EQ(judge_times(run, budget_ms).mean_ms, 11);
  EXPECT_DOUBLE_EQ(fraction_over_model(run, budget_ms), 0.75); // The cost model has only 5 %.
}

TEST(BudgetJudge, SlowRun_IsNotTheMedian) {
  const TimedFigures even = judge_times(run_of({8, 8}), budget_ms),
                     slow = judge_times(run_of({16, 16}), budget_ms);
  EXPECT_DOUBLE_EQ(slow.over, 1);
  const TimedFigures median = median_of({even, slow, even});
  EXPECT_DOUBLE_EQ(median.over, 0);
  EXPECT_DOUBLE_EQ(median.mean_ms, 8);
  EXPECT_DOUBLE_EQ(median_of({slow, even, slow}).over, 1);
}

TEST(BudgetJudge, PoolsSquaresOfTheComparedFrames) {
  SceneRun run = run_of({8, 8, 8});
  run.frames[unjudged_frames].rmse = 3.0;
  run.frames[unjudged_frames + 2].rmse = 1.0;
  EXPECT_DOUBLE_EQ(pooled_rmse(run), std::sqrt(5.0));
}

TEST(BudgetJudge, NamesTheChosenConfigurationsByFraction) {
  SceneRun run = run_of({8, 8, 8, 8});
  const char* names[] = {"technique=off", "technique=sap", "technique=sap", "technique=sap"};
  for (size_t i = 0; i < 4; ++i)
    run.frames[unjudged_frames + i].choice.configuration = names[i];
  EXPECT_EQ(chosen_of(run), "technique=sap 75 %, technique=off 25 %");
}

TEST(BudgetJudge, RatiosLeaveOutBudgetsWithoutABestSingle) {
  BudgetRow good{"good", 1, 10}, bad{"bad", 1, 10}, partial{"partial", 1, 10}, none{"none", 1, 10};
  good.rmse = bad.rmse = partial.rmse = none.rmse = 0.4;
  good.single_rmse = 0.4;
  bad.single_rmse = 0.1;
  partial.single_rmse = 0.2;
  partial.unscattered_rmse = 0.8; // Below all configurations that scatter.
  const RatioSummary summary = summarise_ratios({&good, &bad, &partial, &none});
  EXPECT_EQ(summary.scenes, 2u);
  EXPECT_DOUBLE_EQ(summary.mean, 2); // Geometric: of 1 and 4.
  EXPECT_DOUBLE_EQ(summary.worst, 4);
  EXPECT_EQ(summary.worst_scene, "bad");
}

TEST(BudgetJudge, BudgetsWithoutRoomToScatterAreReportedApart) {
  const std::vector<Single> singles = {single(2, 0.4), single(8, 0.1), single(9, 0.05)};
  EXPECT_TRUE(none_scatters_within(singles, 8)); // 8 ms need 8.71
  EXPECT_TRUE(none_scatters_within(singles, 8.7));
  EXPECT_FALSE(none_scatters_within(singles, 8.72));
  EXPECT_TRUE(none_scatters_within(singles, 1));
  EXPECT_FALSE(none_scatters_within({single(2, 0.4)}, 1)); // nothing scatters at any budget
}

TEST(BudgetJudge, BestSingle_KeepsTheControllersRoomIn99Percent) {
  EXPECT_NEAR(controller_room(), 0.9185, 1e-4);
  std::vector<Single> singles = {single(8, 0.3), single(9.18, 0.2), single(9.19, 0.1)};
  EXPECT_EQ(best_within(singles, budget_ms), &singles[1]);
  EXPECT_EQ(best_within(singles, 7), nullptr);
  singles[2].calibrated_ms.assign(100, 8);
  singles[2].calibrated_ms[50] = 20; // One frame of a hundred.
  EXPECT_EQ(best_within(singles, budget_ms), &singles[2]);
  singles[2].calibrated_ms[51] = 20;
  EXPECT_EQ(best_within(singles, budget_ms), &singles[1]);
}

TEST(BudgetJudge, BudgetsLieBetweenCheapestAndBest) {
  const std::vector<Single> singles = {single(8, 0.3), single(4, 0.5), single(20, 0.1),
                                       single(40, 0.2)};
  EXPECT_DOUBLE_EQ(budget_at(singles, 0.25), 8);
  EXPECT_DOUBLE_EQ(budget_at(singles, 1), 20);
  EXPECT_DOUBLE_EQ(budget_at(singles, 2), 36);
}

} // namespace
} // namespace dermis::tools
