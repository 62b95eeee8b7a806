// Properties of the distribution of samples to tiles.
#include "framegraph/model/splitmix.hpp"
#include "passes/choice/sample_allocation.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace dermis::choice {
namespace {

std::vector<uint32_t> some_tile_errors(size_t tiles, uint64_t seed) {
  SplitMix64 random{seed};
  std::vector<uint32_t> tile_errors(tiles);
  for (uint32_t& tile_error : tile_errors)
    tile_error = random.below(3) == 0 ? 0 : static_cast<uint32_t>(random.below(65536));
  return tile_errors;
}

TEST(SampleAllocation, NeverExceedsTheBudget) {
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    const auto tile_errors = some_tile_errors(400, seed);
    const uint32_t demand = allocate_samples(tile_errors, {}, UINT32_MAX).demand;
    for (uint32_t units = 0; units <= demand + 7; units += 7) {
      const SampleAllocation given = allocate_samples(tile_errors, {}, units);
      uint32_t sum = 0;
      for (const uint32_t steps : given.steps)
        for (uint32_t k = 0; k < steps; ++k)
          sum += step_cost(static_cast<int>(k));
      EXPECT_EQ(sum, given.units);
      EXPECT_LE(given.units, units);
      EXPECT_GE(given.units + 1,
                std::min(units, demand)); // A step of two units may not fit into the last unit.
    }
  }
}

TEST(SampleAllocation, AmpleBudget_AllRequestsAreMet) {
  const auto tile_errors = some_tile_errors(300, 5);
  const SampleAllocation given = allocate_samples(tile_errors, {}, UINT32_MAX);
  for (size_t i = 0; i < tile_errors.size(); ++i)
    EXPECT_EQ(given.steps[i], tile_errors[i] > 0 ? uint32_t{allocation_steps} : 0u);
  EXPECT_EQ(given.units, given.demand);
}

TEST(SampleAllocation, LargerTileError_NeverGetsFewerSamples) {
  const auto tile_errors = some_tile_errors(500, 9);
  const SampleAllocation given = allocate_samples(tile_errors, {}, 300);
  for (size_t i = 0; i < tile_errors.size(); ++i)
    for (size_t j = 0; j < tile_errors.size(); ++j)
      // A bin spans an eighth of a power of two: up to 12.5 %.
      if (tile_errors[i] > 1.126 * tile_errors[j]) {
        EXPECT_GE(given.steps[i], given.steps[j]);
      }
}

TEST(SampleAllocation, EqualTilesAreServedInRowOrder) {
  const std::vector<uint32_t> tile_errors(10, 1000);
  const SampleAllocation given = allocate_samples(tile_errors, {}, 4);
  EXPECT_EQ(given.steps, (std::vector<uint32_t>{1, 1, 1, 1, 0, 0, 0, 0, 0, 0}));
}

TEST(SampleAllocation, Hysteresis_KeepsTilesThatHadSamples) {
  const std::vector<uint32_t> tile_errors = {1000, 1100};
  EXPECT_EQ(allocate_samples(tile_errors, {}, 1).steps, (std::vector<uint32_t>{0, 1}));
  EXPECT_EQ(allocate_samples(tile_errors, std::vector<uint32_t>{1, 0}, 1).steps,
            (std::vector<uint32_t>{1, 0}));
}

// The hull is convex: a later step is never sorted before an earlier step.
TEST(SampleAllocation, StepsOfATileComeInOrder) {
  for (const uint32_t tile_error : {1u, 17u, 4000u, 262144u})
    for (uint32_t before = 0; before <= 3; ++before)
      for (int k = 0; k + 1 < allocation_steps; ++k)
        EXPECT_GT(step_bin(tile_error, k, before), step_bin(tile_error, k + 1, before))
            << tile_error;
}

TEST(SampleAllocation, StepsCostTheirNumberOfSamples) {
  uint32_t units = 0;
  for (int k = 0; k < allocation_steps; ++k) {
    units += step_cost(k);
    EXPECT_EQ(samples_of(static_cast<uint32_t>(k) + 1), static_cast<int>(8 * units));
  }
  EXPECT_EQ(samples_of(0), 0);
}

} // namespace
} // namespace dermis::choice
