// Predicts how many samples tiles will request from a configuration.
#include "passes/choice/sample_demand.hpp"

#include <gtest/gtest.h>

namespace dermis::choice {
namespace {

TEST(SampleDemand, NeverMeasured_IsTheMaximum) {
  const SampleDemand wanted;
  for (const double d_px : {1e-6, 0.1, 1.0, 7.9, 1e4})
    EXPECT_EQ(expected_units(wanted, d_px), double(max_units)) << d_px;
}

// A distant camera, for which no tile requests samples, moves close. The earlier demand of zero
// must not be used here.
TEST(SampleDemand, DistantCamera_DoesNotPredictACloseOne) {
  SampleDemand wanted;
  found_units(wanted, 0.13, 0);
  EXPECT_EQ(expected_units(wanted, 0.14), 0);
  EXPECT_EQ(expected_units(wanted, 1.2), double(max_units));
  found_units(wanted, 1.3, 0.5);
  EXPECT_EQ(expected_units(wanted, 1.2), 0.5);
  EXPECT_EQ(expected_units(wanted, 0.14), 0);
}

TEST(SampleDemand, BeyondTheStoredOctaves_UsesTheNearest) {
  SampleDemand wanted;
  found_units(wanted, 1e-9, 1);
  found_units(wanted, 1e9, 2);
  EXPECT_EQ(expected_units(wanted, 0.125), 1);
  EXPECT_EQ(expected_units(wanted, 64), 2);
}

} // namespace
} // namespace dermis::choice
