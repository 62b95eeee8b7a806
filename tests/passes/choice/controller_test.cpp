#include "passes/choice/controller.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace {

using namespace dermis::choice;

constexpr double frame_seconds = 1.0 / 60;
const std::vector<Forecast> three{{1.0, 0.05, 9e-3}, {2.0, 0.1, 5e-3}, {4.0, 0.2, 2e-3}};

TEST(Decide, TakesTheLeastErrorThatFits) {
  for (const auto& [budget, expected] : {std::pair{1.5, 0u}, {2.5, 1u}, {5.0, 2u}}) {
    DecisionState state;
    EXPECT_EQ(decide(three, budget, frame_seconds, state).outcome, expected) << budget;
  }
}

TEST(Decide, TheTypicalDeviationMustFitAsWell) {
  DecisionState state;
  EXPECT_EQ(decide(three, 2.05, frame_seconds, state).outcome, 0u); // 2.0 alone would fit
}

TEST(Decide, WhereNothingFitsTheFastestRuns) {
  DecisionState state;
  const Decision decision = decide(three, 0.5, frame_seconds, state);
  EXPECT_EQ(decision.outcome, 0u);
  EXPECT_EQ(decision.why, ReasonKind::nothing_fits);
}

TEST(Decide, WhatNoLongerFitsIsLeftAtOnce) {
  DecisionState state;
  EXPECT_EQ(decide(three, 5.0, frame_seconds, state).outcome, 2u);
  const Decision decision = decide(three, 3.0, frame_seconds, state);
  EXPECT_EQ(decision.outcome, 1u);
  EXPECT_EQ(decision.why, ReasonKind::over_budget);
  EXPECT_EQ(state.switches, 1u);
}

TEST(Decide, ABudgetThatSwingsAroundAPriceDoesNotSwitchMoreThanTwiceASecond) {
  DecisionState state;
  constexpr int frames = 600; // ten seconds at 60 Hz
  for (int frame = 0; frame < frames; ++frame)
    decide(three, 4.4 + (frame % 2 == 0 ? 0.3 : -0.3), frame_seconds, state);
  EXPECT_LE(state.switches, 2 * frames / 60);
}

// The second sees what the first does not: the first errs less wherever there is none of it.
TEST(Decide, LightThroughThinPartsIsToldWhereItTipsTheScales) {
  const std::vector<Forecast> lit_in_front{{1.0, 0, 2e-3, 0}, {4.0, 0, 0.1, 0}};
  const std::vector<Forecast> lit_behind{{1.0, 0, 0.3, 0.2999}, {4.0, 0, 0.1, 0}};
  DecisionState state;
  const Decision front = decide(lit_in_front, 5.0, frame_seconds, state);
  EXPECT_EQ(front.outcome, 0u);
  EXPECT_FALSE(front.transmission_stats);
  EXPECT_STREQ(why_text(front), "least error that fits; nothing ran before");
  const Decision behind = decide(lit_behind, 5.0, 1.5, state);
  EXPECT_EQ(behind.why, ReasonKind::held); // a second has to go by
  const Decision later = decide(lit_behind, 5.0, 1.5, state);
  EXPECT_EQ(later.outcome, 1u);
  EXPECT_TRUE(later.transmission_stats);
  EXPECT_STREQ(why_text(later), "less error than before fits now, for light through thin parts");
  const Decision again = decide(lit_behind, 5.0, 1.5, state);
  EXPECT_STREQ(why_text(again), "least error that fits, for light through thin parts");
  const Decision dear = decide(lit_behind, 2.0, 1.5, state); // rays do not fit: nothing was tipped
  EXPECT_EQ(dear.outcome, 0u);
  EXPECT_FALSE(dear.transmission_stats);
  EXPECT_EQ(dear.next_better, 1u);
}

TEST(Decide, ASmallGainIsNoReasonToSwitch) {
  const std::vector<Forecast> alike{{1.0, 0, 5.0e-3}, {1.5, 0, 4.9e-3}};
  DecisionState state;
  EXPECT_EQ(decide(alike, 1.2, frame_seconds, state).outcome, 0u);
  for (int frame = 0; frame < 100; ++frame)
    EXPECT_EQ(decide(alike, 3.0, frame_seconds, state).outcome, 0u);
}

// Slow frames are as far apart in time as many fast ones.
TEST(Decide, WhatIsBetterIsTakenASecondAfterTheLastSwitch) {
  for (const double seconds : {1.0 / 60, 1.0 / 24, 0.0}) {
    DecisionState state;
    decide(three, 1.5, seconds, state);
    double passed = 0;
    while (decide(three, 9.0, seconds, state).outcome != 2u && passed < 10)
      passed += seconds > 0 ? seconds : 1.0 / 60;
    EXPECT_NEAR(passed, 1.0, 0.1) << seconds;
  }
}

TEST(Decide, SaysWhatTheNextBetterOneWouldTake) {
  DecisionState state;
  const Decision decision = decide(three, 2.5, frame_seconds, state);
  EXPECT_EQ(decision.next_better, 2u);
  EXPECT_NEAR(decision.missing_ms, 1.7, 1e-12); // 4.0 + 0.2 - 2.5
  DecisionState other;
  EXPECT_EQ(decide(three, 9, frame_seconds, other).next_better, UINT32_MAX);
}

TEST(Decide, TheSameFramesGiveTheSameDecisions) {
  DecisionState a, b;
  for (int frame = 0; frame < 200; ++frame) {
    const double budget = 1.0 + (frame * 37 % 50) * 0.1;
    EXPECT_EQ(decide(three, budget, frame_seconds, a).outcome,
              decide(three, budget, frame_seconds, b).outcome);
  }
  EXPECT_EQ(a.switches, b.switches);
}

} // namespace
