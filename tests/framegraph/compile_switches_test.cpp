// Tests the compiler options on graphs randomly generated from fixed seeds; `compiled` verifies
// every plan.

#include "tests/framegraph/random_graph.hpp"

#include "framegraph/serialize/plan_file.hpp"

#include <gtest/gtest.h>

#include <set>

namespace dermis::testing {
namespace {

constexpr uint64_t switched_graphs = 120;

uint64_t transient_bytes(const GraphBuilder& builder, const CompileInput& input) {
  return compiled(builder, input).plan.transient_bytes;
}

TEST(Switches, MorePackingEffortNeverEnlargesTheHeap) {
  for (uint64_t seed = 0; seed < switched_graphs; ++seed) {
    SCOPED_TRACE(seed);
    const auto builder = random_graph(seed);
    CompileInput input = builder.input(640, 360);
    input.packing = PackingLevel::fast;
    const uint64_t fast = transient_bytes(builder, input);
    input.packing = PackingLevel::tight;
    EXPECT_LE(transient_bytes(builder, input), fast);
  }
}

TEST(Switches, AliasingOff_HeapIsTheSumOfTransients) {
  uint64_t larger = 0;
  for (uint64_t seed = 0; seed < switched_graphs; ++seed) {
    SCOPED_TRACE(seed);
    const auto builder = random_graph(seed);
    CompileInput input = builder.input();
    const uint64_t shared = transient_bytes(builder, input);
    input.alias = false;
    const auto plan = compiled(builder, input).plan;
    larger += plan.transient_bytes > shared;
    for (size_t i = 0; i < plan.placements.size(); ++i)
      for (size_t j = 0; j < i; ++j) {
        const Placement &a = plan.placements[i], &b = plan.placements[j];
        EXPECT_TRUE(a.heap != b.heap || a.offset + a.size <= b.offset ||
                    b.offset + b.size <= a.offset);
      }
    if (HasFailure()) return;
  }
  // The generator has to make graphs in which aliasing saves memory.
  EXPECT_GT(larger, switched_graphs / 4);
}

// Only the usage flags of the graph's own images and buffers differ.
TEST(Switches, DebugFill_ChangesOnlyUsageFlags) {
  for (uint64_t seed = 0; seed < switched_graphs; ++seed) {
    SCOPED_TRACE(seed);
    const auto builder = random_graph(seed);
    CompileInput input = builder.input();
    const Plan plain = compiled(builder, input).plan;
    input.poison = true;
    Plan plan = compiled(builder, input).plan;
    for (size_t r = 0; r < plan.resources.size(); ++r) {
      const bool own = plan.resources[r].first_instance != no_instance;
      EXPECT_TRUE(!own || (plan.resources[r].vk_usage & usage_info(Usage::clear).vk_usage) != 0);
      plan.resources[r].vk_usage = plain.resources[r].vk_usage;
    }
    EXPECT_EQ(plan_bytes(plan), plan_bytes(plain));
    if (HasFailure()) return;
  }
}

TEST(Switches, ResourceKeptAlive_SharesNoMemory) {
  for (uint64_t seed = 0; seed < switched_graphs; ++seed) {
    SCOPED_TRACE(seed);
    const auto builder = random_graph(seed);
    const auto usual = compiled(builder).plan;
    if (usual.placements.empty()) continue;
    CompileInput input = builder.input();
    input.keep_alive = usual.resources[usual.placements[0].resource].declared;
    const auto plan = compiled(builder, input).plan;
    for (const Placement& kept : plan.placements) {
      if (plan.resources[kept.resource].declared != input.keep_alive) continue;
      for (const Placement& other : plan.placements)
        EXPECT_TRUE(&other == &kept || other.heap != kept.heap ||
                    other.offset + other.size <= kept.offset ||
                    kept.offset + kept.size <= other.offset);
    }
  }
}

TEST(Switches, RandomOrder_IsLegalRepeatableAndVaries) {
  uint64_t graphs_with_choice = 0;
  for (uint64_t seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE(seed);
    const auto builder = random_graph(seed);
    CompileInput input = builder.input();
    input.order = PassOrder::random;
    std::set<std::string> orders;
    for (input.order_seed = 0; input.order_seed < 10; ++input.order_seed) {
      const std::string once = pass_names(builder, compiled(builder, input).plan);
      EXPECT_EQ(once, pass_names(builder, compiled(builder, input).plan));
      orders.insert(once);
    }
    graphs_with_choice += orders.size() > 1;
  }
  EXPECT_GT(graphs_with_choice, 5u); // Dense graphs have only one legal order.
}

TEST(Switches, CullingOff_EveryPassRuns) {
  uint64_t more = 0;
  for (uint64_t seed = 0; seed < switched_graphs; ++seed) {
    SCOPED_TRACE(seed);
    const auto builder = random_graph(seed);
    CompileInput input = builder.input();
    const size_t culled = compiled(builder, input).plan.passes.size();
    input.cull = false;
    const size_t all = compiled(builder, input).plan.passes.size();
    EXPECT_GE(all, culled);
    more += all > culled;
  }
  EXPECT_GT(more, 0u);
}

TEST(Switches, RecordingReasonsDoesNotChangeThePlan) {
  for (uint64_t seed = 0; seed < switched_graphs; ++seed) {
    SCOPED_TRACE(seed);
    const auto builder = random_graph(seed);
    CompileInput input = builder.input();
    const auto with = compiled(builder, input);
    input.reasons = false;
    const auto without = compiled(builder, input);
    EXPECT_TRUE(without.reasons.empty());
    EXPECT_FALSE(with.reasons.empty());
    EXPECT_EQ(with.plan.transient_bytes, without.plan.transient_bytes);
    EXPECT_EQ(pass_names(builder, with.plan), pass_names(builder, without.plan));
    EXPECT_EQ(with.plan.barriers.size(), without.plan.barriers.size());
  }
}

TEST(Switches, ReusedCompiler_MakesTheSamePlan) {
  Compiler used;
  for (uint64_t seed = 0; seed < switched_graphs; ++seed) {
    SCOPED_TRACE(seed);
    const auto builder = random_graph(seed);
    const CompileInput input = builder.input();
    Diagnostics diagnostics;
    CompiledPlan again;
    ASSERT_TRUE(used.compile(input, diagnostics, again));
    const auto fresh = compiled(builder, input);
    EXPECT_EQ(again.plan.transient_bytes, fresh.plan.transient_bytes);
    ASSERT_EQ(again.plan.barriers.size(), fresh.plan.barriers.size());
    for (size_t i = 0; i < fresh.plan.placements.size(); ++i)
      EXPECT_EQ(again.plan.placements[i].offset, fresh.plan.placements[i].offset);
    EXPECT_EQ(pass_names(builder, again.plan), pass_names(builder, fresh.plan));
  }
}

} // namespace
} // namespace dermis::testing
