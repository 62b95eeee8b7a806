// Predicts how many samples tiles will request from a configuration.
#include "passes/choice/sample_demand.hpp"

#include <gtest/gtest.h>

namespace dermis::choice {
namespace {

TEST(SampleDemand, NeverMeasured_IsTheMaximum) {
  const SampleDemand demand;
  for (const double d_px : {1e-6, 0.1, 1.0, 7.9, 1e4})
    EXPECT_EQ(expected_units(demand, d_px), double(max_units)) << d_px;
}

// A distant camera, for which no tile requests samples, moves close. The earlier demand of zero
// must not be used here, and samples may be tried again at a distance.
TEST(SampleDemand, DistantCamera_DoesNotPredictACloseOne) {
  SampleDemand demand;
  record_units(demand, 0.13, 0);
  EXPECT_EQ(expected_units(demand, 0.14), min_units_per_tile);
  EXPECT_EQ(expected_units(demand, 1.2), double(max_units));
  record_units(demand, 1.3, 0.5);
  EXPECT_EQ(expected_units(demand, 1.2), 0.5);
  EXPECT_EQ(expected_units(demand, 0.14), min_units_per_tile);
}

TEST(SampleDemand, BeyondTheStoredOctaves_UsesTheNearest) {
  SampleDemand demand;
  record_units(demand, 1e-9, 1);
  record_units(demand, 1e9, 2);
  EXPECT_EQ(expected_units(demand, 0.125), 1);
  EXPECT_EQ(expected_units(demand, 64), 2);
}

TEST(SampleDemand, Forecasts_UseTheNearestObservation) {
  SampleDemand demand;
  EXPECT_EQ(likely_units(demand, 2), double(max_units));
  record_units(demand, 0.3, 0.5);
  record_units(demand, 6, 3);
  EXPECT_EQ(likely_units(demand, 0.3), 0.5);
  EXPECT_EQ(likely_units(demand, 0.8), 0.5);
  EXPECT_EQ(likely_units(demand, 3), 3);
  EXPECT_EQ(likely_units(demand, 50), 3);
}

} // namespace
} // namespace dermis::choice
