#include "passes/choice/affine_fit.hpp"

#include <gtest/gtest.h>

namespace {

using namespace dermis::choice;

// A device whose passes take 0.05 ms and 20 us per 100 groups.
constexpr AffineCost real{0.05, 0.0002};
constexpr AffineCost no_prior{};

AffineFit fitted(int runs, auto ms_of) {
  AffineFit fit;
  for (int i = 0; i < runs; ++i) {
    const double groups = 100 + i * 97 % 3000;
    observe(fit, no_prior, false, groups, ms_of(i, groups));
  }
  return fit;
}

TEST(AffineFit, FindsBaseAndSlopeOfADevice) {
  const AffineFit fit = fitted(60, [](int, double groups) { return real.ms(groups); });
  const AffineCost found = solve(fit, no_prior, false);
  for (const double groups : {200.0, 1000.0, 3000.0})
    EXPECT_NEAR(found.ms(groups), real.ms(groups), 0.03 * real.ms(groups)); // the prior of 0 pulls
}

TEST(AffineFit, OutlierInOneOfEightRunsHasLittleEffect) {
  const AffineFit fit =
      fitted(200, [](int i, double groups) { return real.ms(groups) * (i % 8 == 7 ? 5 : 1); });
  // Least squares would follow the mean, 1.5 times the real time.
  EXPECT_NEAR(solve(fit, no_prior, false).ms(1500), real.ms(1500), 0.2 * real.ms(1500));
}

TEST(AffineFit, FasterWithMoreGroups_IsTheMeanTime) {
  AffineFit fit;
  for (int i = 0; i < 40; ++i)
    observe(fit, no_prior, false, i % 2 == 0 ? 100 : 1000, i % 2 == 0 ? 2.0 : 1.8);
  const AffineCost found = solve(fit, no_prior, false);
  EXPECT_EQ(found.group_ms, 0);
  EXPECT_NEAR(found.base_ms, 1.9, 0.05); // not 0: the dispatch takes its time
}

TEST(AffineFit, NegativeBase_IsZero) {
  AffineFit fit;
  for (int i = 0; i < 40; ++i)
    observe(fit, no_prior, false, i % 2 == 0 ? 1000 : 2000, i % 2 == 0 ? 0.5 : 2.0);
  const AffineCost found = solve(fit, no_prior, false);
  EXPECT_EQ(found.base_ms, 0);
  EXPECT_NEAR(found.ms(1500), 1.3, 0.15);
}

TEST(AffineFit, WithoutRuns_IsThePrior) {
  const AffineCost found = solve({}, real, true);
  EXPECT_EQ(found.base_ms, real.base_ms);
  EXPECT_EQ(found.group_ms, real.group_ms);
}

} // namespace
