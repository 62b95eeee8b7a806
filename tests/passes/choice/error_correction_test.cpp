// Probe measurements correct the errors that the table expects.
#include "framegraph/model/splitmix.hpp"
#include "passes/choice/error_correction.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace {

using namespace dermis;
using namespace dermis::choice;

constexpr double expected = 0.002;
constexpr FrameKey content = {3, 0.01};
constexpr double interval_s = 1.0 / 60;

constexpr double unscattered = 0.02; // as expected by the table

ProbedFrame frame_of(int32_t technique, double square, double table = expected, double now_s = 0) {
  return {technique, square, unscattered * unscattered, table, unscattered, content, now_s};
}

// Returns the correction of techniques that are no variants of each other.
ErrorCorrection correction_for(size_t techniques, int32_t compared = -1) {
  ErrorModel table;
  for (size_t t = 0; t < techniques; ++t)
    table.techniques.push_back(
        {std::string(1, char('a' + t)), {{std::string(1, char('a' + t)), {}}}, {{1, 1}}});
  ErrorCorrection correction = make_error_correction(table);
  correction.compared = compared;
  return correction;
}

// Observes `frames` frames of a technique, from `now_s` on.
void observe(ErrorCorrection& correction, int32_t technique, double probed, int frames,
             double& now_s) {
  for (int i = 0; i < frames; ++i, now_s += interval_s)
    observe_error(correction, frame_of(technique, probed * probed, expected, now_s));
}

TEST(ErrorCorrection, NoProbe_KeepsTheTable) {
  const ErrorCorrection none = correction_for(2);
  for (const int32_t technique : {-1, 0, 1, 7})
    EXPECT_EQ(error_factor(none, technique, content, 0), 1);
}

TEST(ErrorCorrection, SelectedTiles_LeaveTheMeasuredPartOfTheError) {
  constexpr double exponent = 0.5, selected = 0.4, by_table = 5;
  ErrorCorrection correction = correction_for(2, 1);
  const auto concentration = [&](const FrameKey& key, bool cut = false) {
    return selection_concentration(correction, by_table, key, 0, cut);
  };
  EXPECT_EQ(concentration(content), by_table);
  ProbedFrame frame = frame_of(1, expected * expected);
  frame.compared_square = frame.square;
  frame.compared_expected = expected;
  frame.selection_square =
      frame.square + std::pow(1 - selected, exponent) * (frame.unscattered_square - frame.square);
  observe_error(correction, frame); // weights of tiles still change
  EXPECT_EQ(concentration(content), by_table);
  frame.selected = selected;
  for (int i = 0; i < 200; ++i)
    observe_error(correction, frame);
  // The table counts as 2 frames, the measurements as 25.
  const double left = (25 * std::pow(0.6, exponent) + 2 * std::pow(0.6, by_table)) / 27;
  EXPECT_NEAR(concentration(content), std::log(left) / std::log(0.6), 0.01);
  EXPECT_NEAR(concentration({16 * content.d_px, content.relief}), by_table, 0.01);
  EXPECT_GT(concentration(content, true), 4);
  forget_errors(correction);
  EXPECT_GT(concentration(content), 4);
  recall_errors(correction);
  EXPECT_LT(concentration(content), 1);
}

TEST(ErrorCorrection, FindsTheFactorInNoisyProbes) {
  SplitMix64 random{7};
  ErrorCorrection correction = correction_for(2);
  constexpr double factor = 2;
  for (int i = 0; i < 100; ++i) {
    // Squares are uniform between -1 and 3 times their mean.
    const double square = 4 * static_cast<double>(random.next() >> 11) * 0x1p-53 - 1;
    observe_error(correction, frame_of(1, std::pow(factor * expected, 2) * square));
  }
  // Tolerance: 25 frames of squares with a deviation of 2/sqrt(3) of their mean give 23 % of the
  // square, so 12 % of the root. The table's 2 of 27 frames add 3 % of the root. The bound is two
  // deviations plus the table's part.
  EXPECT_NEAR(error_factor(correction, 1, content, 0), factor, factor * (2 * 0.12 + 0.03));
  EXPECT_EQ(error_factor(correction, 0, content, 0), 1);
  EXPECT_EQ(error_factor(correction, -1, content, 0), 1);
}

// A table of techniques without samples, whose first pass has the type. All have the same spread.
ErrorModel table_of(std::initializer_list<const char*> pass_types) {
  ErrorModel table;
  for (const char* type : pass_types)
    table.techniques.push_back({type, {{type, {}}}, {{1, 1, 2}}});
  return table;
}

// A variant is expected to deviate from the table as much as the one that ran.
TEST(ErrorCorrection, VariantsShareWhatIsMeasured) {
  ErrorCorrection correction = make_error_correction(table_of({"sap", "sap", "separable"}));
  double now_s = 0;
  observe(correction, 0, 8 * expected, 200, now_s);
  const double measured = error_factor(correction, 0, content, now_s);
  EXPECT_NEAR(measured, 8, 0.4);
  EXPECT_NEAR(error_factor(correction, 1, content, now_s), measured, 1e-9);
  EXPECT_EQ(error_factor(correction, 2, content, now_s), 1);
  observe(correction, 1, 2 * expected, 200, now_s);
  // Two frames of the variant, 25 of its own.
  EXPECT_NEAR(error_factor(correction, 1, content, now_s), std::sqrt((25 * 4 + 2 * 64) / 27.0),
              0.3);
  EXPECT_NEAR(error_factor(correction, 0, content, now_s), measured, 0.1 * measured);
}

// The errors of a variant whose rows have half the spread deviate half as much from the table.
TEST(ErrorCorrection, VariantsWithLessSpread_DeviateLess) {
  ErrorModel table = table_of({"sap", "sap", "sap"});
  table.techniques[0].curve.front().spread = 4;
  table.techniques[2].curve.front().spread = 16;
  ErrorCorrection correction = make_error_correction(table);
  double now_s = 0;
  observe(correction, 0, 8 * expected, 200, now_s);
  const double measured = std::log(error_factor(correction, 0, content, now_s));
  EXPECT_NEAR(std::log(error_factor(correction, 1, content, now_s)), measured / 2, 1e-9);
  EXPECT_NEAR(std::log(error_factor(correction, 2, content, now_s)), measured, 1e-9)
      << "more spread is no reason to expect a larger deviation than measured";
}

TEST(ErrorCorrection, OldMeasurementsOfVariants_CountLess) {
  ErrorCorrection correction = make_error_correction(table_of({"sap", "sap", "sap"}));
  double now_s = 0;
  observe(correction, 0, expected, 200, now_s);
  now_s += 600;
  observe(correction, 1, 3 * expected, 200, now_s);
  EXPECT_NEAR(error_factor(correction, 2, content, now_s), 3, 0.2);
}

// At half resolution, other errors prevail.
TEST(ErrorCorrection, HalfResolutionIsNoVariant) {
  ErrorCorrection correction = make_error_correction(table_of({"sap", "sap_half"}));
  double now_s = 0;
  observe(correction, 0, 8 * expected, 200, now_s);
  EXPECT_EQ(error_factor(correction, 1, content, now_s), 1);
}

TEST(ErrorCorrection, ProbesCompareSeparableWith25Taps) {
  ErrorModel table;
  for (const char* taps : {"11", "25"})
    table.techniques.push_back(
        {taps, {{"subsurface.separable", {{"taps", taps}, {"kernel", "fitted"}}}}, {{1, 1}}});
  EXPECT_EQ(make_error_correction(table).compared, 1);
  EXPECT_EQ(make_error_correction({}).compared, -1);
}

TEST(ErrorCorrection, ComparedTechnique_NeedNotRun) {
  constexpr int32_t running = 0, compared = 1, other = 2;
  ErrorCorrection correction = correction_for(3, compared);
  ProbedFrame frame = frame_of(running, std::pow(1.5 * expected, 2));
  frame.compared_expected = 2 * expected;
  frame.compared_square = std::pow(0.5 * frame.compared_expected, 2);
  for (int i = 0; i < 200; ++i)
    observe_error(correction, frame);
  // Tolerance: the table has 2 of 27 frames.
  EXPECT_NEAR(error_factor(correction, running, content, 0), 1.5, 0.1);
  EXPECT_NEAR(error_factor(correction, compared, content, 0), 0.5, 0.1);
  EXPECT_EQ(error_factor(correction, other, content, 0), 1);
}

TEST(ErrorCorrection, ComparedTechnique_CountsOnceIfItRuns) {
  ErrorCorrection running_only = correction_for(2), both = correction_for(2, 1);
  ProbedFrame frame = frame_of(1, std::pow(1.5 * expected, 2));
  for (int i = 0; i < 5; ++i) {
    observe_error(running_only, frame);
    frame.compared_square = frame.square;
    frame.compared_expected = expected;
    observe_error(both, frame);
  }
  EXPECT_EQ(error_factor(both, 1, content, 0), error_factor(running_only, 1, content, 0));
}

TEST(ErrorCorrection, Outlier_CountsAtMostThreeTimesTheEstimate) {
  ErrorCorrection correction = correction_for(1);
  for (int i = 0; i < 100; ++i)
    observe_error(correction, frame_of(0, expected * expected));
  observe_error(correction, frame_of(0, 1e6));
  // One of 25 + 2 frames has nine times the square, the others have the expected square.
  EXPECT_NEAR(error_factor(correction, 0, content, 0), std::sqrt((26 + 9.0) / 27), 0.02);
}

TEST(ErrorCorrection, MeasuredFramesAgeWithTheContent) {
  ErrorCorrection correction = correction_for(2);
  EXPECT_EQ(measured_frames(correction, 0, content, 0), 0);
  double now_s = 0;
  observe(correction, 0, expected, 10, now_s);
  const double measured = measured_frames(correction, 0, content, now_s);
  EXPECT_NEAR(measured, 10, 2); // Older frames count less.
  EXPECT_EQ(measured_frames(correction, 1, content, now_s), 0);
  EXPECT_LT(measured_frames(correction, 0, {4 * content.d_px, content.relief}, now_s), 1);
  EXPECT_LT(measured_frames(correction, 0, content, now_s, true), 1) << "after a cut";
  for (const int32_t none : {-2, 2})
    EXPECT_EQ(measured_frames(correction, none, content, now_s), 0);
}

TEST(ErrorCorrection, MeasurementsHold_WhileOtherTechniquesRun) {
  ErrorCorrection correction = correction_for(2);
  double now_s = 0;
  observe(correction, 0, 3 * expected, 50, now_s);
  const double known = error_factor(correction, 0, content, now_s);
  EXPECT_GT(known, 2.5);
  observe(correction, 1, expected, 300, now_s); // 5 s
  EXPECT_NEAR(error_factor(correction, 0, content, now_s), known, 0.1 * known);
  observe(correction, 1, expected, 60 * 300, now_s); // 5 minutes
  EXPECT_NEAR(error_factor(correction, 0, content, now_s), 1, 0.02);
}

TEST(ErrorCorrection, MeasurementsHold_WhileTheContentIsSimilar) {
  ErrorCorrection correction = correction_for(1);
  double now_s = 0;
  observe(correction, 0, 3 * expected, 50, now_s);
  const double known = error_factor(correction, 0, content, now_s);
  const auto at = [&](double d_px, double relief) {
    return error_factor(correction, 0, {d_px, relief}, now_s);
  };
  EXPECT_GT(at(1.2 * content.d_px, content.relief), 0.9 * known);
  EXPECT_GT(at(content.d_px, 1.3 * content.relief), 0.9 * known);
  EXPECT_LT(at(4 * content.d_px, content.relief), 1.1);
  EXPECT_LT(at(content.d_px, 20 * content.relief), 1.1);
  EXPECT_NEAR(at(content.d_px, -1), known, 0.01 * known) << "relief is not known";
}

TEST(ErrorCorrection, CutForgetsAllButTheRunningTechnique) {
  ErrorCorrection correction = correction_for(2);
  double now_s = 0;
  observe(correction, 0, 3 * expected, 50, now_s);
  observe(correction, 1, 3 * expected, 50, now_s);
  forget_errors(correction);
  observe(correction, 1, 3 * expected, 25, now_s);
  EXPECT_NEAR(error_factor(correction, 0, content, now_s), 1, 0.1);
  EXPECT_GT(error_factor(correction, 1, content, now_s), 2);
}

TEST(ErrorCorrection, DiscardedCut_ForgetsNothing) {
  ErrorCorrection correction = correction_for(2);
  double now_s = 0;
  observe(correction, 0, 3 * expected, 50, now_s);
  const double before = error_factor(correction, 0, content, now_s);
  const double of_the_cut = error_factor(correction, 0, content, now_s, true);
  forget_errors(correction);
  EXPECT_LT(of_the_cut, 1.1);
  EXPECT_EQ(error_factor(correction, 0, content, now_s), of_the_cut);
  recall_errors(correction);
  EXPECT_EQ(error_factor(correction, 0, content, now_s), before);
}

// A choice takes the technique with the least expected error, where each technique's true error
// deviates from the table. Returns the geometric mean over frames of its error, relative to the
// best technique's, and the number of switches.
std::pair<double, int> choose_by_measurements(uint64_t seed, bool corrected) {
  SplitMix64 random{seed};
  const auto uniform = [&] { return static_cast<double>(random.next() >> 11) * 0x1p-53; };
  std::array<double, 4> table{}, truth{};
  for (size_t t = 0; t < table.size(); ++t) {
    table[t] = expected * std::exp(uniform());
    truth[t] = table[t] * std::exp(2.6 * (uniform() - 0.5));
  }
  ErrorCorrection correction = correction_for(table.size());
  constexpr int frames = 1200;
  size_t running = table.size();
  int switches = -1;
  double now_s = 0, logs = 0;
  for (int i = 0; i < frames; ++i, now_s += interval_s) {
    const auto error = [&](size_t t) {
      return table[t] * (corrected ? error_factor(correction, int32_t(t), content, now_s) : 1);
    };
    size_t best = 0;
    for (size_t t = 1; t < table.size(); ++t)
      if (error(t) < error(best)) best = t;
    if (running == table.size() || error(best) < 0.95 * error(running)) {
      ++switches;
      running = best;
    }
    const double square = std::pow(truth[running], 2) * (4 * uniform() - 1); // noisy
    observe_error(correction, frame_of(int32_t(running), square, table[running], now_s));
    logs += std::log(truth[running] / *std::min_element(truth.begin(), truth.end()));
  }
  return {std::exp(logs / frames), switches};
}

TEST(ErrorCorrection, ChoiceSettlesNearTheBestTechnique) {
  constexpr int runs = 60;
  double with = 0, without = 0;
  int switches = 0;
  for (uint64_t seed = 1; seed <= runs; ++seed) {
    const auto [error, changes] = choose_by_measurements(seed, true);
    with += std::log(error) / runs;
    without += std::log(choose_by_measurements(seed, false).first) / runs;
    switches = std::max(switches, changes);
  }
  RecordProperty("with", std::to_string(std::exp(with)));
  RecordProperty("without", std::to_string(std::exp(without)));
  RecordProperty("switches", switches);
  EXPECT_LE(std::exp(with), 1.15);
  EXPECT_GE(std::exp(without), 1.5) << "the table is wrong enough";
  EXPECT_LE(switches, 12) << "in 20 s";
}

// Brightness, exposure and detail of the light change the errors of all techniques.
TEST(ErrorCorrection, UnitsOfTheLight_AreCommonToAllTechniques) {
  for (const double unit : {0.01, 0.2, 5.0, 300.0}) {
    ErrorCorrection correction = correction_for(2);
    for (int i = 0; i < 50; ++i) {
      ProbedFrame frame = frame_of(0, std::pow(2 * unit * expected, 2));
      frame.unscattered_square *= unit * unit;
      observe_error(correction, frame);
    }
    EXPECT_NEAR(error_factor(correction, -1, content, 0), unit, 0.02 * unit);
    EXPECT_NEAR(error_factor(correction, 0, content, 0), 2 * unit, 0.2 * unit);
    EXPECT_NEAR(error_factor(correction, 1, content, 0), unit, 0.02 * unit);
  }
}

TEST(ErrorCorrection, UniformLight_LeavesFactorsUnchanged) {
  ErrorCorrection correction = correction_for(1);
  for (int i = 0; i < 50; ++i) {
    ProbedFrame frame = frame_of(0, 1e-9);
    frame.unscattered_square = 0;
    observe_error(correction, frame);
  }
  EXPECT_LT(error_factor(correction, 0, content, 0), 1e-3);
}

TEST(ErrorCorrection, LightThatIsSwitchedOn_IsNoErrorOfTheTechnique) {
  ErrorCorrection correction = correction_for(1);
  ProbedFrame dark = frame_of(0, 0);
  dark.unscattered_square = 0;
  for (int i = 0; i < 50; ++i)
    observe_error(correction, dark);
  ErrorCorrection always_lit = correction_for(1);
  for (int i = 0; i < 8; ++i) {
    observe_error(correction, frame_of(0, expected * expected));
    observe_error(always_lit, frame_of(0, expected * expected));
    const auto own = [](const ErrorCorrection& one) {
      return error_factor(one, 0, content, 0) / error_factor(one, -1, content, 0);
    };
    EXPECT_NEAR(own(correction), own(always_lit), 1e-3) << i;
    if (i < 2) continue; // Three frames make a step.
    EXPECT_NEAR(error_factor(correction, -1, content, 0), 1, 0.1) << i;
  }
}

// The errors of single tiles differ by orders of magnitude, and a frame probes few tiles.
TEST(ErrorCorrection, NoisyLight_LeavesFactorsOfTheTechniqueNearOne) {
  constexpr int tiles = 8, frames = 4000;
  constexpr double spread = 2.5, own_spread = 0.5; // of the logarithm
  SplitMix64 random{11};
  const auto normal = [&] { // with variance 1
    double sum = -6;
    for (int i = 0; i < 12; ++i)
      sum += static_cast<double>(random.next() >> 11) * 0x1p-53;
    return sum;
  };
  ErrorCorrection correction = correction_for(1);
  double own = 0, worst = 1;
  for (int i = 0; i < frames; ++i) {
    ProbedFrame frame = frame_of(0, 0);
    frame.unscattered_square = 0;
    for (int t = 0; t < tiles; ++t) {
      const double light = std::exp(spread * normal() - spread * spread / 2) / tiles;
      frame.unscattered_square += light * unscattered * unscattered;
      frame.square += light * std::exp(own_spread * normal() - own_spread * own_spread / 2) *
                      expected * expected;
    }
    observe_error(correction, frame);
    const double factor =
        error_factor(correction, 0, content, 0) / error_factor(correction, -1, content, 0);
    own += std::log(factor) / frames;
    worst = std::max({worst, factor, 1 / factor});
  }
  EXPECT_NEAR(own, 0, 0.03);
  EXPECT_LT(worst, 1.3);
}

TEST(ErrorCorrection, InvalidErrors_AreIgnored) {
  ErrorCorrection correction = correction_for(1);
  for (const double wrong : {std::nan(""), double{INFINITY}})
    observe_error(correction, frame_of(0, wrong));
  observe_error(correction, frame_of(0, expected * expected, 0));
  observe_error(correction, frame_of(5, expected * expected));
  EXPECT_EQ(error_factor(correction, 0, content, 0), 1);
}

} // namespace
