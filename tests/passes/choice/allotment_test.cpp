// Laws of who gets samples.
#include "framegraph/model/splitmix.hpp"
#include "passes/choice/allotment.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace dermis::choice {
namespace {

std::vector<uint32_t> some_doubts(size_t tiles, uint64_t seed) {
  SplitMix64 random{seed};
  std::vector<uint32_t> doubts(tiles);
  for (uint32_t& doubt : doubts)
    doubt = random.below(3) == 0 ? 0 : static_cast<uint32_t>(random.below(65536));
  return doubts;
}

TEST(Allotment, NeverSpendsMoreThanItMay) {
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    const auto doubts = some_doubts(400, seed);
    const uint32_t wanted = allot(doubts, {}, UINT32_MAX).wanted;
    for (uint32_t units = 0; units <= wanted + 7; units += 7) {
      const Allotment given = allot(doubts, {}, units);
      uint32_t sum = 0;
      for (const uint32_t steps : given.steps)
        for (uint32_t k = 0; k < steps; ++k)
          sum += step_cost(static_cast<int>(k));
      EXPECT_EQ(sum, given.units);
      EXPECT_LE(given.units, units);
      EXPECT_GE(given.units + 1,
                std::min(units, wanted)); // a step of two units may not fit into the last one
    }
  }
}

TEST(Allotment, EnoughGivesEveryDoubtfulTileAllAndNoneToTheSure) {
  const auto doubts = some_doubts(300, 5);
  const Allotment given = allot(doubts, {}, UINT32_MAX);
  for (size_t i = 0; i < doubts.size(); ++i)
    EXPECT_EQ(given.steps[i], doubts[i] > 0 ? uint32_t{allot_steps} : 0u);
  EXPECT_EQ(given.units, given.wanted);
}

TEST(Allotment, ATileWithMoreDoubtNeverGetsLessByMoreThanABin) {
  const auto doubts = some_doubts(500, 9);
  const Allotment given = allot(doubts, {}, 300);
  for (size_t i = 0; i < doubts.size(); ++i)
    for (size_t j = 0; j < doubts.size(); ++j)
      if (doubts[i] > 1.126 * doubts[j]) { // a bin spans an eighth of a power of two: up to 12.5 %
        EXPECT_GE(given.steps[i], given.steps[j]);
      }
}

TEST(Allotment, EqualTilesAreServedInRowOrder) {
  const std::vector<uint32_t> doubts(10, 1000);
  const Allotment given = allot(doubts, {}, 4);
  EXPECT_EQ(given.steps, (std::vector<uint32_t>{1, 1, 1, 1, 0, 0, 0, 0, 0, 0}));
}

TEST(Allotment, WhoHadSamplesKeepsThemAgainstASlightlyBetterOther) {
  const std::vector<uint32_t> doubts = {1000, 1100};
  EXPECT_EQ(allot(doubts, {}, 1).steps, (std::vector<uint32_t>{0, 1}));
  EXPECT_EQ(allot(doubts, std::vector<uint32_t>{1, 0}, 1).steps, (std::vector<uint32_t>{1, 0}));
}

TEST(Allotment,
     StepsOfATileComeInOrder) { // the hull is convex: a later step never stands before an earlier one
  for (const uint32_t doubt : {1u, 17u, 4000u, 262144u})
    for (uint32_t before = 0; before <= 3; ++before)
      for (int k = 0; k + 1 < allot_steps; ++k)
        EXPECT_GT(step_bin(doubt, k, before), step_bin(doubt, k + 1, before)) << doubt;
}

TEST(Allotment, StepsCostWhatTheirSamplesDo) {
  uint32_t units = 0;
  for (int k = 0; k < allot_steps; ++k) {
    units += step_cost(k);
    EXPECT_EQ(samples_of(static_cast<uint32_t>(k) + 1), static_cast<int>(8 * units));
  }
  EXPECT_EQ(samples_of(0), 0);
}

} // namespace
} // namespace dermis::choice
