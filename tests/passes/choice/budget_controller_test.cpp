#include "tests/passes/choice/decide_fixture.hpp"

#include <cmath>

namespace {

using namespace dermis::choice;
using namespace dermis::deciding;

TEST_F(Decide, TakesTheSmallestErrorThatFits) {
  for (const auto& [budget, expected] : {std::pair{1.5, 0u}, {2.5, 1u}, {5.0, 2u}}) {
    state = {};
    EXPECT_EQ(decide(three, budget).configuration, expected) << budget;
  }
}

TEST_F(Decide, MarginMustFitTheBudget) {
  EXPECT_EQ(decide(three, 2.05).configuration, 0u); // 2.0 ms would fit without the margin
}

TEST_F(Decide, NothingFits_TheFastestRuns) {
  const Decision decision = decide(three, 0.5);
  EXPECT_EQ(decision.configuration, 0u);
  EXPECT_EQ(decision.why, ReasonKind::nothing_fits);
}

TEST_F(Decide, NothingFits_NoiseOfTimesDoesNotSwitch) {
  for (int i = 0; i < 600; ++i) {
    const double noise = i / 60 % 2 == 0 ? 1.01 : 0.99;
    decide({known(3, 5e-3), known(3 * noise, 9e-3)}, 2);
  }
  EXPECT_EQ(state.switches, 0u);
  decide({known(3, 5e-3), known(2.5, 9e-3)}, 2);
  EXPECT_EQ(state.current, 1u);
}

// It ran between the limits of entering and leaving, so it may also return there.
// The first seconds are for trials. A long first frame, as after a level was loaded, does not end
// them before any time was measured.
// A menu before the first character.
TEST_F(Decide, SamplesOfUntriedWork_FitPessimistically) {
  Forecast sampled = unknown(2, 2e-3);
  sampled.takes_samples = true;
  sampled.demand = 1000;
  sampled.unsampled_rmse = 5e-3;
  sampled.time.unit_ms = sampled.time.undisturbed_unit_ms = 0.01;
  const Decision decision = decide({sampled}, 4);
  EXPECT_GT(decision.units, 0);
  EXPECT_LE(decision.bound_ms, 4 + 1e-9);
}

TEST_F(Decide, ConfigurationOverBudget_IsLeftAtOnce) {
  EXPECT_EQ(decide(three, 5.0).configuration, 2u);
  const Decision decision = decide(three, 3.0);
  EXPECT_EQ(decision.configuration, 1u);
  EXPECT_EQ(decision.why, ReasonKind::trial_failed); // within a second of its start
  EXPECT_EQ(decision.rejected, 2u);
  EXPECT_EQ(state.switches, 1u);
}

TEST_F(Decide, OscillatingBudget_SwitchesAtMostOncePerTwoSeconds) {
  constexpr int frames = 600; // ten seconds
  for (int i = 0; i < frames; ++i)
    decide(three, 4.4 + (i % 2 == 0 ? 0.6 : -0.6));
  EXPECT_LE(state.switches, 2u + frames / 120);
}

// Between the limits of entering and leaving, the running configuration stays. Without hysteresis
// it would change with each frame.
TEST_F(Decide, TimesNearTheLimit_DoNotSwitch) {
  const double limit = 4.2 * std::exp(-margin);
  for (const bool dear_runs : {true, false}) {
    state = {};
    decide({known(1, 9e-3), known(dear_runs ? 3.0 : 9.0, 2e-3)}, 4.2);
    const uint32_t first = state.current;
    EXPECT_EQ(first, dear_runs ? 1u : 0u);
    for (int i = 0; i < 3600; ++i) {
      const double ms = limit * (i / 30 % 2 == 0 ? 0.985 : 1.012);
      decide({known(1, 9e-3), known(ms, 2e-3)}, 4.2);
    }
    EXPECT_EQ(state.switches, 0u) << dear_runs;
    EXPECT_EQ(state.current, first);
  }
}

TEST_F(Decide, ErrorsAlmostEqual_DoNotSwitch) {
  for (int i = 0; i < 3600; ++i)
    decide({known(1, i / 30 % 2 == 0 ? 5.0e-3 : 4.95e-3), known(1, 4.97e-3)}, 3.0);
  EXPECT_LE(state.switches, 0u);
}

// A forecast whose error was measured in probed frames.
Forecast measured(double rmse, double frames = 20) {
  Forecast forecast = known(1, rmse);
  forecast.error_frames = frames;
  return forecast;
}

TEST_F(Decide, UnprovenError_MustBeMuchSmaller) {
  decide({measured(5e-3), known(1, 6e-3)}, 2);
  EXPECT_EQ(decide({measured(5e-3), known(1, 4.7e-3)}, 2).configuration, 0u);
  EXPECT_EQ(decide({measured(5e-3), measured(4.7e-3, 2)}, 2).configuration, 0u);
  EXPECT_EQ(decide({measured(5e-3), known(1, 4.2e-3)}, 2).configuration, 1u);
}

TEST_F(Decide, ProvenError_OrNoProbe_IsTakenIfSmaller) {
  for (const double frames : {0.0, 20.0}) {
    state = {};
    decide({measured(5e-3, frames), known(1, 6e-3)}, 2);
    EXPECT_EQ(decide({measured(5e-3, frames), measured(4.7e-3, frames)}, 2).configuration, 1u);
  }
}

TEST_F(Decide, UnprovenError_WaitsForTheErrorOfWhatRuns) {
  decide({measured(5e-3), known(1, 6e-3)}, 2);
  frame.learning = true;
  const Decision decision = decide({measured(5e-3), known(1, 3e-3)}, 2);
  EXPECT_EQ(decision.configuration, 0u);
  EXPECT_EQ(decision.why, ReasonKind::held);
  EXPECT_EQ(decide({measured(5e-3), measured(3e-3)}, 2).configuration, 1u) << "it is proven";
}

TEST_F(Decide, UnprovenError_IsLeftAtOnceIfItWasWrong) {
  decide({measured(5e-3), known(1, 6e-3)}, 2);
  ASSERT_EQ(decide({measured(5e-3), known(1, 3e-3)}, 2).configuration, 1u);
  EXPECT_EQ(decide({measured(5e-3), measured(8e-3, 1)}, 2).configuration, 0u);
  // The next one waits until it, too, can be left at once.
  for (int i = 0; i < 230; ++i) // 3.8 s
    ASSERT_EQ(decide({measured(5e-3), measured(3e-3, 1)}, 2).configuration, 0u) << i;
  for (int i = 0; i < 20; ++i)
    decide({measured(5e-3), measured(3e-3, 1)}, 2);
  EXPECT_EQ(state.current, 1u);
}

// Another unproven configuration does not keep the way back from being taken.
TEST_F(Decide, UnprovenError_DoesNotHideTheWayBack) {
  decide({measured(5e-3), known(1, 6e-3), known(1, 6e-3)}, 2);
  ASSERT_EQ(decide({measured(5e-3), known(1, 3e-3), known(1, 4.4e-3)}, 2).configuration, 1u);
  EXPECT_EQ(decide({measured(5e-3), measured(8e-3, 2), known(1, 4.4e-3)}, 2).configuration, 0u);
}

// A third configuration that is a little better, but needs another token, does not do so either.
TEST_F(Decide, BetterConfiguration_DoesNotHideTheWayBack) {
  decide({measured(5e-3), known(1, 6e-3), measured(6e-3)}, 2);
  ASSERT_EQ(decide({measured(5e-3), known(1, 3e-3), measured(6e-3)}, 2).configuration, 1u);
  EXPECT_EQ(decide({measured(5e-3), measured(8e-3, 2), measured(4.9e-3)}, 2).configuration, 0u);
}

// The configuration before may return up to the time at which it would have been left.
TEST_F(Decide, WrongError_IsLeftForWhatWouldNotBeEntered) {
  Forecast before = measured(5e-3);
  const auto takes = [](Forecast forecast, double ms) {
    forecast.time = known(ms, 0).time;
    return forecast;
  };
  decide({takes(before, 3.5), known(1, 6e-3)}, 4);
  before = takes(before, 3.8);
  ASSERT_EQ(decide({before, known(1, 6e-3)}, 4).configuration, 0u);
  ASSERT_EQ(decide({before, known(1, 3e-3)}, 4).configuration, 1u);
  EXPECT_EQ(decide({before, measured(8e-3)}, 4).configuration, 0u);
}

// If nothing scatters, times and errors are those of no work.
TEST_F(Decide, IdleFrames_SwitchOnlyIfOverBudget) {
  decide({measured(5e-3), known(4, 1e-3)}, 2);
  frame.idle = true;
  for (int i = 0; i < 300; ++i)
    ASSERT_EQ(decide({measured(5e-3), known(1, 1e-3)}, 2).configuration, 0u);
  EXPECT_EQ(decide({known(3, 5e-3), known(1, 1e-3)}, 2).configuration, 1u);
}

// Without timestamps, and in deterministic mode, there is nothing to try.
TEST_F(Decide, CertainTimes_AreEnteredWhenTheyFit) {
  for (int i = 0; i < 600; ++i)
    ASSERT_EQ(decide({known(0.5, 9e-3), known(0.95, 2e-3)}, 1).configuration, 0u);
  decide({known(0.5, 9e-3), known(0.95, 2e-3)}, 1.05);
  EXPECT_EQ(state.current, 1u);
}

// The long pause of what was not tried at first ends when it runs.
TEST_F(Decide, FarSmallerError_NeedsFewerTokens) {
  for (const double rmse : {3e-3, 2e-3}) {
    state = {};
    decide({measured(5e-3), known(1, 6e-3)}, 2);
    state.tokens = 1.6;
    EXPECT_EQ(decide({measured(5e-3), known(1, rmse)}, 2).configuration, rmse < 2.5e-3 ? 1u : 0u);
  }
}

// Also if its error is known well by then.
TEST_F(Decide, FarSmallerErrorThatWasWrong_IsLeftAfterASecond) {
  decide({measured(5e-3), known(1, 6e-3)}, 2);
  state.tokens = 1.6;
  ASSERT_EQ(decide({measured(5e-3), known(1, 2e-3)}, 2).configuration, 1u);
  for (int i = 0; i < 60; ++i)
    decide({measured(5e-3), measured(8e-3)}, 2);
  EXPECT_EQ(state.current, 0u);
}

// An unproven one that only might fit does not keep a certain one from running.
TEST_F(Decide, Trial_DoesNotHideAFarSmallerError) {
  decide({measured(5e-3), known(1, 6e-3), known(1, 6e-3)}, 2);
  state.tokens = 1.6;
  EXPECT_EQ(decide({measured(5e-3), unknown(1.5, 1.9e-3), known(1, 2e-3)}, 2).configuration, 2u);
}

TEST_F(Decide, UnprovenError_IsNotLeftForASmallDifference) {
  decide({measured(5e-3), known(1, 6e-3)}, 2);
  ASSERT_EQ(decide({measured(5e-3), known(1, 3e-3)}, 2).configuration, 1u);
  EXPECT_EQ(decide({measured(5e-3), measured(5.3e-3, 2)}, 2).configuration, 1u)
      << "two frames tell little";
  EXPECT_EQ(decide({measured(5e-3), measured(5.3e-3, 6)}, 2).configuration, 0u);
}

TEST_F(Decide, CutsTakeUnprovenErrors) {
  decide({measured(5e-3), known(1, 6e-3)}, 2);
  frame.cut = frame.learning = true;
  EXPECT_EQ(decide({measured(5e-3), known(1, 4.7e-3)}, 2).configuration, 1u);
}

// Rays find light beyond the screen, which the probe's reference lacks.
TEST_F(Decide, ErrorsThatProbesCannotTell_AreThoseOfTheTable) {
  Forecast rays = known(1, 4.7e-3);
  rays.is_probed = false;
  decide({measured(5e-3), known(1, 6e-3)}, 2);
  EXPECT_EQ(decide({measured(5e-3), rays}, 2).configuration, 1u);
}

// A proven configuration is taken instead of an unproven one with slightly less error.
TEST_F(Decide, ProvenError_IsPreferred) {
  decide({measured(5e-3), known(1, 6e-3), known(1, 6e-3)}, 2);
  EXPECT_EQ(decide({measured(5e-3), known(1, 3.9e-3), measured(4e-3)}, 2).configuration, 2u);
}

// The second configuration includes transmission. The first has less error in views without
// transmission.
TEST_F(Decide, TransmissionIsTheReasonIfItDecides) {
  const std::vector<Forecast> lit_in_front{known(1, 2e-3), known(4, 0.1)};
  const std::vector<Forecast> lit_behind{known(1, 0.3, 0.2999), known(4, 0.1)};
  const Decision front = decide(lit_in_front, 5.0);
  EXPECT_EQ(front.configuration, 0u);
  EXPECT_FALSE(front.by_transmission);
  EXPECT_STREQ(why_text(front), "least error within the budget; first frame");
  const Decision behind = decide(lit_behind, 5.0, 1.5);
  EXPECT_EQ(behind.configuration, 1u);
  EXPECT_TRUE(behind.by_transmission);
  EXPECT_STREQ(
      why_text(behind),
      "a configuration with less error now fits the budget, considering transmitted light");
  const Decision again = decide(lit_behind, 5.0, 1.5);
  EXPECT_STREQ(why_text(again), "least error within the budget, considering transmitted light");
  // The rays do not fit, so transmission did not change the decision.
  const Decision dear = decide(lit_behind, 2.0, 1.5);
  EXPECT_EQ(dear.configuration, 0u);
  EXPECT_FALSE(dear.by_transmission);
  EXPECT_EQ(dear.next_better, 1u);
}

// A configuration that fits even at its pessimistic time needs no trial.
// A disturbed configuration is tried at its usual time after 2, 4, 8 ... s.
// Disturbed for half a second out of fifteen: the back-off never restarts, but it ends.
TEST_F(Decide, BetterConfiguration_IsTakenAtOnce) {
  decide(three, 1.5);
  EXPECT_EQ(decide(three, 9.0).configuration, 2u);
}

TEST_F(Decide, Provisional_IsReplacedWithoutASwitch) {
  frame.provisional = true;
  decide(three, 1.5); // the whole view may scatter
  frame.provisional = false;
  EXPECT_EQ(decide(three, 9.0).configuration, 2u);
  EXPECT_EQ(state.switches, 0u);
}

TEST_F(Decide, ReportsTheTimeMissingForTheNextBetter) {
  const Decision decision = decide(three, 2.5);
  EXPECT_EQ(decision.next_better, 2u);
  const double gap = 0.02 + 0.3 * margin;
  EXPECT_NEAR(decision.missing_ms, 4 * std::exp(margin + gap) - 2.5, 1e-9);
  state = {};
  EXPECT_EQ(decide(three, 9).next_better, no_configuration);
}

// 2 ms, and 1 us per unit of samples.
Forecast sampled(double demand) {
  Forecast forecast = known(2, 2e-3);
  forecast.takes_samples = true;
  forecast.unsampled_rmse = 4e-3;
  forecast.demand = demand;
  forecast.time.unit_ms = forecast.time.undisturbed_unit_ms = 1e-3;
  return forecast;
}

TEST_F(Decide, Samples_FillTheBudgetLessTheMargin) {
  const double fit = (3 * std::exp(-margin) - 2) * 1000;
  const Decision some = decide({sampled(5000)}, 3);
  EXPECT_NEAR(some.units, fit, 1e-6);
  EXPECT_NEAR(some.bound_ms, 3, 1e-9);
  EXPECT_NEAR(some.rmse, 1e-3 * std::sqrt(16 + fit / 5000 * (4 - 16)), 1e-9);
  // The spare budget may be taken if more is requested than expected.
  const Decision all = decide({sampled(100)}, 3);
  EXPECT_EQ(all.units, 100);
  EXPECT_NEAR(all.max_units, fit, 1e-6);
}

TEST_F(Decide, NoSamplesForLong_ReturnWhenTheyFit) {
  for (int i = 0; i < 600; ++i)
    EXPECT_EQ(decide({sampled(5000)}, 2.05).units, 0);
  EXPECT_GT(decide({sampled(5000)}, 3).units, 800);
}

TEST_F(Decide, SamplesIncreaseOnlyByMoreThanNoise) {
  const double units = decide({sampled(5000)}, 3).units;
  EXPECT_EQ(decide({sampled(5000)}, 3.02).units, units);
  EXPECT_LT(decide({sampled(5000)}, 2.98).units, units);
}

TEST_F(Decide, CopiedState_GivesEqualDecisions) {
  DecisionState copy;
  for (int i = 0; i < 400; ++i) {
    const double budget = 1.0 + (i * 37 % 50) * 0.1;
    const uint32_t here = decide(three, budget).configuration;
    if (i < 200) {
      copy = state;
      continue;
    }
    std::swap(copy, state);
    EXPECT_EQ(decide(three, budget).configuration, here) << i;
    std::swap(copy, state);
  }
  EXPECT_EQ(copy.switches, state.switches);
}

} // namespace
