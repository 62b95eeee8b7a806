// Plans of one graph share memory, because only one of them runs in a frame.

#include "tests/framegraph/graph_builder.hpp"

#include "framegraph/compile/shared_heaps.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace dermis::testing {
namespace {

constexpr uint64_t kib = 1024;

// A plan with one heap of transients and one of histories, whose history is the graph's resource
// `history`. Sizes are in KiB; 0: no such heap.
Plan plan_of(uint64_t transients, uint64_t histories, uint32_t history = 0,
             uint32_t memory_types = 1) {
  Plan plan;
  if (transients > 0)
    plan.heaps.push_back({memory_types, transients * kib, 256, transients * kib, false});
  if (histories > 0) {
    plan.heaps.push_back({memory_types, histories * kib, 256, histories * kib, true});
    PlanResource resource;
    resource.declared = ResourceId{history};
    resource.first_instance = 0;
    resource.instance_count = 1;
    plan.resources.push_back(resource);
    plan.histories.emplace_back();
    plan.placements.emplace_back();
    plan.placements.back().heap = static_cast<uint32_t>(plan.heaps.size()) - 1;
    plan.placements.back().persistent = true;
  }
  return plan;
}

SharedHeaps shared(const std::vector<Plan>& plans,
                   HistoryMemory histories = HistoryMemory::shared) {
  std::vector<const Plan*> all;
  for (const Plan& plan : plans)
    all.push_back(&plan);
  return share_heaps(all, histories);
}

TEST(SharedHeaps, HistoryOfOnePlan_OverlapsOtherTransients) {
  const SharedHeaps heaps = shared({plan_of(85, 0), plan_of(23, 79)});
  ASSERT_EQ(heaps.blocks.size(), 1u);
  EXPECT_EQ(heaps.blocks[0].bytes, (23 + 79) * kib);
  EXPECT_TRUE(heaps.blocks[0].history);
  EXPECT_EQ(heaps.transient_bytes, 0u);
  EXPECT_EQ(heaps.history_bytes, (23 + 79) * kib);
  EXPECT_EQ(heaps.places[0][0].offset, 0u);
  EXPECT_EQ(heaps.places[1][0].offset, 0u);
  EXPECT_EQ(heaps.places[1][1].offset, 23 * kib) << "not over the transients of its own plan";
}

// A block with a history cannot be aliased by a host.
TEST(SharedHeaps, HistoryThatGainsNothing_StaysSeparate) {
  const SharedHeaps heaps = shared({plan_of(40, 30), plan_of(10, 0)});
  EXPECT_EQ(heaps.transient_bytes, 40 * kib);
  EXPECT_EQ(heaps.history_bytes, 30 * kib);
  EXPECT_EQ(heaps.places[0][1].block, no_block);
}

TEST(SharedHeaps, HistoryOfTwoPlans_HasItsOwnMemory) {
  const SharedHeaps heaps = shared({plan_of(10, 8, 3), plan_of(20, 8, 3), plan_of(0, 9, 4)});
  EXPECT_EQ(heaps.places[0][1].block, no_block);
  EXPECT_EQ(heaps.places[1][1].block, no_block);
  EXPECT_EQ(heaps.places[2][0].block, 0u);
  EXPECT_EQ(heaps.history_bytes, (8 + 8 + 20) * kib);
}

TEST(SharedHeaps, SeparateHistories_LeaveTransientBlocks) {
  const SharedHeaps heaps = shared({plan_of(85, 0), plan_of(23, 79)}, HistoryMemory::separate);
  ASSERT_EQ(heaps.blocks.size(), 1u);
  EXPECT_FALSE(heaps.blocks[0].history);
  EXPECT_EQ(heaps.transient_bytes, 85 * kib);
  EXPECT_EQ(heaps.history_bytes, 79 * kib);
}

TEST(SharedHeaps, DifferentMemoryTypes_HaveSeparateBlocks) {
  const SharedHeaps heaps = shared({plan_of(4, 0, 0, 1), plan_of(5, 0, 0, 2)});
  EXPECT_EQ(heaps.blocks.size(), 2u);
  EXPECT_EQ(heaps.transient_bytes, 9 * kib);
}

TEST(SharedHeaps, SinglePlanSharesNothing) {
  const SharedHeaps heaps = shared({plan_of(23, 79)});
  EXPECT_TRUE(heaps.blocks.empty());
  EXPECT_EQ(heaps.transient_bytes, 23 * kib);
  EXPECT_EQ(heaps.history_bytes, 79 * kib);
}

TEST(SharedHeaps, HeapsAreAlignedAsTheDeviceNeeds) {
  const Plan first = plan_of(9, 0), second = plan_of(3, 2);
  const Plan* plans[] = {&first, &second};
  const auto alignment = [](const Plan&, uint32_t) { return 4 * kib; };
  const SharedHeaps heaps = share_heaps(plans, HistoryMemory::shared, alignment);
  EXPECT_EQ(heaps.places[1][1].offset, 4 * kib);
  EXPECT_EQ(heaps.blocks[0].bytes, 9 * kib);
  EXPECT_EQ(heaps.blocks[0].alignment, 4 * kib);
}

} // namespace
} // namespace dermis::testing
