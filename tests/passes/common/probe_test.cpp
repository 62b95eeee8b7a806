#include "passes/common/probe.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>

namespace dermis::subsurface {
namespace {

FrameCounters counters_of(uint32_t tiles, float square) {
  FrameCounters counters{};
  counters.probe_count = tiles;
  for (uint32_t i = 0; i < tiles; ++i)
    counters.probes[i] = {std::bit_cast<uint32_t>(square), std::bit_cast<uint32_t>(1.0f)};
  return counters;
}

TEST(ProbedError, IsTheMeanOfTheTiles) {
  const ProbedError probed = probed_error(counters_of(max_probes, 4));
  EXPECT_EQ(probed.tiles, max_probes);
  EXPECT_EQ(probed.rmse, 2);
  EXPECT_EQ(probed_error(counters_of(0, 4)).tiles, 0u);
}

TEST(ProbedError, ValuesThatAreNotFinite_AreNoMeasurement) {
  for (const float wrong : {std::numeric_limits<float>::quiet_NaN(), HUGE_VALF}) {
    FrameCounters counters = counters_of(max_probes, 4);
    for (uint32_t i = 0; i < max_probes; i += 2)
      counters.probes[i][0] = std::bit_cast<uint32_t>(wrong);
    EXPECT_EQ(probed_error(counters).tiles, 0u);
  }
}

} // namespace
} // namespace dermis::subsurface
