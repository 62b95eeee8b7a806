// Checks properties that hold for every plan, on graphs randomly generated from fixed seeds.

#include "tests/framegraph/plan_mutations.hpp"
#include "tests/framegraph/random_graph.hpp"

#include "framegraph/verify/verify.hpp"

#include <gtest/gtest.h>

namespace dermis::testing {
namespace {

constexpr uint64_t seeds = 400;

TEST(RandomGraphs, EveryPlanIsAcceptedByTheVerifier) {
  uint64_t passes = 0, barriers = 0, histories = 0, aliases = 0;
  for (uint64_t seed = 0; seed < seeds; ++seed) {
    SCOPED_TRACE(seed);
    const auto plan = compiled(random_graph(seed)).plan;
    if (HasFailure()) return;
    passes += plan.passes.size();
    barriers += plan.barriers.size();
    histories += plan.histories.size();
    for (const PlanBarrier& barrier : plan.barriers)
      aliases += barrier.why == PlanBarrier::ReasonKind::alias;
  }
  // The generator has to produce enough passes and barriers for the property to mean anything.
  EXPECT_GT(passes, 5 * seeds);
  EXPECT_GT(barriers, 10 * seeds);
  EXPECT_GT(histories, seeds / 4);
  EXPECT_GT(aliases, seeds / 4);
}

TEST(RandomGraphs, NoBarrierCanBeDropped) {
  for (uint64_t seed = 0; seed < seeds; ++seed) {
    const auto builder = random_graph(seed);
    const auto whole = compiled(builder);
    for (uint32_t b = 0; b < whole.plan.barriers.size(); ++b)
      EXPECT_FALSE(verify(without_barrier(whole.plan, b)).violations.empty())
          << "seed " << seed << ", barrier " << b << ": "
          << reasons(builder, whole, Reason::About::barrier, b);
    if (HasFailure()) return;
  }
}

TEST(RandomGraphs, HeapSize_IsAtLeastThePeakOfLiveMemory) {
  uint64_t heaps = 0, optimal = 0;
  for (uint64_t seed = 0; seed < seeds; ++seed) {
    const auto plan = compiled(random_graph(seed)).plan;
    for (const Heap& heap : plan.heaps) {
      EXPECT_GE(heap.size, heap.max_live_bytes);
      ++heaps;
      optimal += heap.size == heap.max_live_bytes;
    }
  }
  // Best fit by size reaches the lower bound on nearly all small graphs.
  EXPECT_GT(optimal * 10, heaps * 9);
}

} // namespace
} // namespace dermis::testing
