// Probe measurements correct the errors that the table expects.
#include "framegraph/model/splitmix.hpp"
#include "passes/choice/error_correction.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace {

using namespace dermis;
using namespace dermis::choice;

constexpr double expected = 0.002;

TEST(ErrorCorrection, NoProbe_KeepsTheTable) {
  const ErrorCorrection none = make_error_correction(2);
  for (const int32_t technique : {-1, 0, 1, 7})
    EXPECT_EQ(error_factor(none, technique), 1);
}

TEST(ErrorCorrection, FindsTheFactorInNoisyProbes) {
  SplitMix64 random{7};
  ErrorCorrection correction = make_error_correction(2);
  constexpr double factor = 2;
  for (int i = 0; i < 100; ++i) {
    // Squares are uniform between 0 and twice their mean.
    const double square = 2 * static_cast<double>(random.next() >> 11) * 0x1p-53;
    observe_error(correction, 1, factor * expected * std::sqrt(square), expected);
  }
  // Tolerance: 25 frames of squares with a deviation of 1/sqrt(3) of their mean give 12 % of the
  // square, so 6 % of the root. The table's 4 of 29 frames add 5 % of the root. The bound is three
  // deviations plus the table's part.
  EXPECT_NEAR(error_factor(correction, 1), factor, factor * (3 * 0.06 + 0.06));
  EXPECT_EQ(error_factor(correction, 0), 1);
  EXPECT_EQ(error_factor(correction, -1), 1);
}

TEST(ErrorCorrection, Outlier_CountsAtMostThreeTimesTheEstimate) {
  ErrorCorrection correction = make_error_correction(1);
  for (int i = 0; i < 100; ++i)
    observe_error(correction, 0, expected, expected);
  observe_error(correction, 0, 1e6 * expected, expected);
  // One of 25 + 4 frames has nine times the square, the others have the expected square.
  EXPECT_NEAR(error_factor(correction, 0), std::sqrt((28 + 9.0) / 29), 0.02);
}

TEST(ErrorCorrection, OldMeasurementsAreForgotten) {
  ErrorCorrection correction = make_error_correction(2);
  for (int i = 0; i < 50; ++i)
    observe_error(correction, 0, 3 * expected, expected);
  const double known = error_factor(correction, 0);
  EXPECT_GT(known, 2.5);
  double before = known;
  for (int i = 0; i < 200; ++i) {
    observe_error(correction, 1, expected, expected);
    EXPECT_LE(error_factor(correction, 0), before);
    before = error_factor(correction, 0);
  }
  EXPECT_NEAR(before, 1, 0.01);
}

TEST(ErrorCorrection, InvalidErrors_AreIgnored) {
  ErrorCorrection correction = make_error_correction(1);
  for (const double wrong : {std::nan(""), double{INFINITY}, -1.0})
    observe_error(correction, 0, wrong, expected);
  observe_error(correction, 0, expected, 0);
  observe_error(correction, 5, expected, expected);
  EXPECT_EQ(error_factor(correction, 0), 1);
}

} // namespace
