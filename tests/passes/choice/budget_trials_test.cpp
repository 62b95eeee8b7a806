// Trials of configurations whose time is unknown or was disturbed.

#include "tests/passes/choice/decide_fixture.hpp"

#include <cmath>

namespace {

using namespace dermis::choice;
using namespace dermis::deciding;

const std::vector<Forecast> three_untried{known(1, 9e-3), unknown(6, 2e-3), unknown(6, 3e-3),
                                          unknown(6, 4e-3)};

struct FirstTrials : Decide {
  // Each of three_untried, which take longer than the budget, runs within 1.5 s.
  void expect_all_tried() {
    std::vector<Forecast> all = three_untried;
    for (int i = 0; i < 90; ++i)
      if (const uint32_t now = decide(all, 4).configuration; now != 0)
        all[now] = known(9, all[now].rmse);
    for (uint32_t i = 1; i < 4; ++i)
      EXPECT_TRUE(state.configurations[i].ran) << i;
  }
};

TEST_F(Decide, NothingFits_TriesWhatMightFit) {
  EXPECT_EQ(decide({known(3, 5e-3), unknown(4, 9e-3)}, 2).configuration, 0u);
  Decision decision;
  for (int i = 0; i < 300 && decision.why != ReasonKind::trial; ++i)
    decision = decide({known(3, 5e-3), unknown(4, 9e-3)}, 2);
  EXPECT_EQ(decision.why, ReasonKind::trial);
  EXPECT_EQ(decision.configuration, 1u);
  decision = decide({known(3, 5e-3), known(1.5, 9e-3)}, 2);
  EXPECT_EQ(decision.configuration, 1u);
  EXPECT_EQ(decision.why, ReasonKind::fits_best);
}

TEST_F(Decide, FailedTrial_ReturnsToWhatRan) {
  std::vector<Forecast> all{known(1, 5e-2), known(3.5, 5e-3), known(9, 2e-3)};
  for (int i = 0; i < 300; ++i)
    decide(all, 4);
  all[1] = known(3.83, 5e-3);
  EXPECT_EQ(decide(all, 4).configuration, 1u);
  all[2] = unknown(6, 2e-3);
  EXPECT_EQ(decide(all, 4).why, ReasonKind::trial);
  all[2] = known(9, 2e-3);
  const Decision decision = decide(all, 4);
  EXPECT_EQ(decision.configuration, 1u);
  EXPECT_EQ(decision.why, ReasonKind::trial_failed);
}

TEST_F(Decide, LongFirstFrame_DoesNotEndTheTrials) {
  Forecast untimed = known(6, 2e-3); // without timestamps the optimistic time is the expected one
  untimed.time.measured = false;
  EXPECT_EQ(decide({known(1, 9e-3), untimed}, 4, 10).configuration, 0u);
  for (int i = 0; i < 60; ++i)
    decide({known(1, 9e-3), unknown(6, 2e-3)}, 4);
  EXPECT_EQ(state.current, 1u);
}

TEST_F(FirstTrials, BudgetSetLater_StillBeginsWithTrials) {
  restart(state, 4, 3);
  for (int i = 0; i < 600; ++i)
    skip_frame(state, frame_seconds);
  expect_all_tried();
}

TEST_F(FirstTrials, FramesWithoutWork_DoNotEndTheTrials) {
  for (const bool empty : {false, true}) {
    state = {};
    restart(state, 4, 3);
    (empty ? frame.empty : frame.idle) = true;
    for (int i = 0; i < 600; ++i)
      decide(three_untried, 1.5);
    frame.empty = frame.idle = false;
    expect_all_tried();
  }
}

TEST_F(Decide, ConfigurationThatWasSetAside_ReturnsLikeOthers) {
  const Forecast cheap = known(1, 9e-3);
  Forecast better = unknown(9, 2e-3);
  for (int i = 0; i < 300; ++i)
    decide({cheap, better}, 2);
  ASSERT_EQ(state.configurations[1].backoff_s, 300);
  better = unknown(1.2, 2e-3);
  for (int i = 0; i < 300; ++i)
    decide({cheap, better}, 2);
  ASSERT_EQ(state.current, 1u);
  better = known(1.2, 2e-3);
  for (int i = 0; i < 600; ++i)
    decide({cheap, better}, 2);
  for (int i = 0; i < 10; ++i)
    decide({cheap, known(3, 2e-3)}, 2);
  ASSERT_EQ(state.current, 0u);
  EXPECT_LE(state.configurations[1].backoff_s, 2);
}

TEST_F(Decide, UnknownTime_IsTriedIfItMightFit) {
  const std::vector<Forecast> forecasts{known(1, 9e-3), unknown(3, 2e-3)};
  EXPECT_EQ(decide(forecasts, 2.5).configuration, 0u); // the first frame is not a trial
  const Decision tried = decide(forecasts, 2.5);
  EXPECT_EQ(tried.configuration, 1u);
  EXPECT_EQ(tried.why, ReasonKind::trial);
  // Its time was measured and does not fit.
  const std::vector<Forecast> measured{known(1, 9e-3), known(3, 2e-3)};
  const Decision back = decide(measured, 2.5);
  EXPECT_EQ(back.configuration, 0u);
  EXPECT_EQ(back.why, ReasonKind::trial_failed);
  EXPECT_EQ(back.rejected, 1u);
  for (int i = 0; i < 3600; ++i)
    EXPECT_EQ(decide(measured, 2.5).configuration, 0u) << i;
}

TEST_F(Decide, Trials_FollowTheHost) {
  const std::vector<Forecast> forecasts{known(1, 9e-3), unknown(3, 2e-3)};
  for (const Trials trials : {Trials::cuts_only, Trials::off}) {
    state = {};
    frame.trials = trials;
    for (int i = 0; i < 600; ++i) {
      frame.cut = i == 300;
      decide(forecasts, 2.5);
      EXPECT_EQ(state.current, i >= 300 && trials == Trials::cuts_only ? 1u : 0u) << i;
    }
  }
}

TEST_F(Decide, TrialsOff_StillTakesWhatFits) {
  frame.trials = Trials::off;
  decide({known(1, 9e-3), unknown(3, 2e-3)}, 2.5);
  EXPECT_EQ(decide({known(1, 9e-3), unknown(1.2, 2e-3)}, 2.5).configuration, 1u);
}

TEST_F(Decide, DisturbedConfiguration_IsTriedWithBackOff) {
  Forecast disturbed = known(5, 2e-3);
  std::vector<double> tried_s;
  decide({known(1, 9e-3), known(2, 2e-3)}, 2.5);
  for (int i = 0; i < 60 * 60; ++i) {
    const bool runs = state.current == 1;
    disturbed.time.undisturbed_ms = runs ? 5 : 2;
    disturbed.time.optimistic_ms = 5;
    if (decide({known(1, 9e-3), disturbed}, 2.5).why == ReasonKind::trial)
      tried_s.push_back(i * frame_seconds);
  }
  ASSERT_GE(tried_s.size(), 4u);
  EXPECT_LE(tried_s.size(), 6u);
  for (size_t i = 0; i + 2 < tried_s.size(); ++i)
    EXPECT_NEAR((tried_s[i + 2] - tried_s[i + 1]) / (tried_s[i + 1] - tried_s[i]), 2, 0.2);
}

TEST_F(Decide, PeriodicDisturbance_DoesNotLockOut) {
  decide({known(1, 9e-3), known(2, 2e-3)}, 2.5);
  int ran = 0;
  constexpr int minutes = 60;
  for (int i = 0; i < minutes * 3600; ++i) {
    const bool disturbed = i % 900 < 30;
    Forecast better = known(disturbed ? 3.2 : 2, 2e-3);
    if (state.current != 1) { // its last time is remembered
      better = known(3.2, 2e-3);
      better.time.undisturbed_ms = 2;
    }
    const bool runs = decide({known(1, 9e-3), better}, 2.5).configuration == 1;
    ran += runs && i >= (minutes - 10) * 3600 ? 1 : 0;
  }
  EXPECT_GE(ran, 10 * 3600 / 10) << "of the last ten minutes";
  EXPECT_LE(state.configurations[1].backoff_s, 64);
}

} // namespace
