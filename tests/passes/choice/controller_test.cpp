#include "passes/choice/controller.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace {

using namespace dermis::choice;

constexpr double frame_seconds = 1.0 / 60;
const std::vector<Forecast> three{{1.0, 0.05, 9e-3}, {2.0, 0.1, 5e-3}, {4.0, 0.2, 2e-3}};

TEST(Decide, TakesTheSmallestErrorThatFits) {
  for (const auto& [budget, expected] : {std::pair{1.5, 0u}, {2.5, 1u}, {5.0, 2u}}) {
    DecisionState state;
    EXPECT_EQ(decide(three, budget, frame_seconds, state).configuration, expected) << budget;
  }
}

TEST(Decide, TypicalDeviationMustFitTheBudget) {
  DecisionState state;
  // 2.0 ms would fit without the deviation.
  EXPECT_EQ(decide(three, 2.05, frame_seconds, state).configuration, 0u);
}

TEST(Decide, NothingFits_TheFastestRuns) {
  DecisionState state;
  const Decision decision = decide(three, 0.5, frame_seconds, state);
  EXPECT_EQ(decision.configuration, 0u);
  EXPECT_EQ(decision.why, ReasonKind::nothing_fits);
}

TEST(Decide, ConfigurationOverBudget_IsLeftAtOnce) {
  DecisionState state;
  EXPECT_EQ(decide(three, 5.0, frame_seconds, state).configuration, 2u);
  const Decision decision = decide(three, 3.0, frame_seconds, state);
  EXPECT_EQ(decision.configuration, 1u);
  EXPECT_EQ(decision.why, ReasonKind::over_budget);
  EXPECT_EQ(state.switches, 1u);
}

TEST(Decide, OscillatingBudget_SwitchesAtMostTwicePerSecond) {
  DecisionState state;
  constexpr int frames = 600; // Ten seconds at 60 Hz.
  for (int frame = 0; frame < frames; ++frame)
    decide(three, 4.4 + (frame % 2 == 0 ? 0.3 : -0.3), frame_seconds, state);
  EXPECT_LE(state.switches, 2 * frames / 60);
}

// The second configuration includes transmission. The first has less error in views without
// transmission.
TEST(Decide, TransmissionIsTheReasonIfItDecides) {
  const std::vector<Forecast> lit_in_front{{1.0, 0, 2e-3, 0}, {4.0, 0, 0.1, 0}};
  const std::vector<Forecast> lit_behind{{1.0, 0, 0.3, 0.2999}, {4.0, 0, 0.1, 0}};
  DecisionState state;
  const Decision front = decide(lit_in_front, 5.0, frame_seconds, state);
  EXPECT_EQ(front.configuration, 0u);
  EXPECT_FALSE(front.transmission_stats);
  EXPECT_STREQ(why_text(front), "least error within the budget; first frame");
  const Decision behind = decide(lit_behind, 5.0, 1.5, state);
  EXPECT_EQ(behind.why, ReasonKind::held); // A second has to pass before the next switch.
  const Decision later = decide(lit_behind, 5.0, 1.5, state);
  EXPECT_EQ(later.configuration, 1u);
  EXPECT_TRUE(later.transmission_stats);
  EXPECT_STREQ(
      why_text(later),
      "a configuration with less error now fits the budget, considering transmitted light");
  const Decision again = decide(lit_behind, 5.0, 1.5, state);
  EXPECT_STREQ(why_text(again), "least error within the budget, considering transmitted light");
  // The rays do not fit, so transmission did not change the decision.
  const Decision dear = decide(lit_behind, 2.0, 1.5, state);
  EXPECT_EQ(dear.configuration, 0u);
  EXPECT_FALSE(dear.transmission_stats);
  EXPECT_EQ(dear.next_better, 1u);
}

TEST(Decide, SmallGain_DoesNotSwitch) {
  const std::vector<Forecast> alike{{1.0, 0, 5.0e-3}, {1.5, 0, 4.9e-3}};
  DecisionState state;
  EXPECT_EQ(decide(alike, 1.2, frame_seconds, state).configuration, 0u);
  for (int frame = 0; frame < 100; ++frame)
    EXPECT_EQ(decide(alike, 3.0, frame_seconds, state).configuration, 0u);
}

// In seconds, few slow frames are as long as many fast frames.
TEST(Decide, BetterConfiguration_IsTakenAfterASecond) {
  for (const double seconds : {1.0 / 60, 1.0 / 24, 0.0}) {
    DecisionState state;
    decide(three, 1.5, seconds, state);
    double passed = 0;
    while (decide(three, 9.0, seconds, state).configuration != 2u && passed < 10)
      passed += seconds > 0 ? seconds : 1.0 / 60;
    EXPECT_NEAR(passed, 1.0, 0.1) << seconds;
  }
}

TEST(Decide, ReportsTheTimeMissingForTheNextBetter) {
  DecisionState state;
  const Decision decision = decide(three, 2.5, frame_seconds, state);
  EXPECT_EQ(decision.next_better, 2u);
  EXPECT_NEAR(decision.missing_ms, 1.7, 1e-12); // 4.0 + 0.2 - 2.5 ms
  DecisionState other;
  EXPECT_EQ(decide(three, 9, frame_seconds, other).next_better, UINT32_MAX);
}

TEST(Decide, EqualFramesGiveEqualDecisions) {
  DecisionState a, b;
  for (int frame = 0; frame < 200; ++frame) {
    const double budget = 1.0 + (frame * 37 % 50) * 0.1;
    EXPECT_EQ(decide(three, budget, frame_seconds, a).configuration,
              decide(three, budget, frame_seconds, b).configuration);
  }
  EXPECT_EQ(a.switches, b.switches);
}

} // namespace
