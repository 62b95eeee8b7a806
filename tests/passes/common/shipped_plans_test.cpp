// Checks every shipped graph with combinations of optional slots: the plan is verified, nothing in
// it can be removed, and it computes the graph's result.
// DERMIS_TESTS_FULL tries every combination of optional slots, 4,096 of restir, each with fewer
// orders. Without DERMIS_TESTS_FULL, graphs with more than five such slots are tried with up to two
// bound and with up to two unbound.

#include "tests/framegraph/graph_reference.hpp"
#include "tests/framegraph/hazard_oracle.hpp"
#include "tests/framegraph/plan_mutations.hpp"
#include "tests/framegraph/second_opinion.hpp"
#include "tests/framegraph/test_scale.hpp"

#include "framegraph/compile/compile.hpp"
#include "framegraph/model/read_graph.hpp"
#include "framegraph/verify/verify.hpp"
#include "passes/common/pass_types.hpp"
#include "tests/support/shipped_graphs.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <filesystem>
#include <functional>

namespace {

using namespace dermis;
using namespace dermis::testing;

constexpr uint32_t frames = 5;
constexpr size_t few_slots = 5, few_bound = 2;

// Returns whether this run tries the combination; `unbound` has a bit for each of `slots` slots.
bool tried(uint32_t unbound, size_t slots) {
  const auto missing = static_cast<size_t>(std::popcount(unbound));
  return slots <= few_slots || missing <= few_bound || slots - missing <= few_bound ||
         seeds_to_try(0, 1) == 1;
}

struct ShippedPlans : ::testing::Test {
  PassTypeRegistry pass_types = subsurface::make_pass_types();
  DeviceProfile device = generic_profile();

  static std::vector<std::string> files() {
    std::vector<std::string> out;
    for (const std::string& file : dermis::shipped::graph_files())
      out.push_back(DERMIS_SOURCE_DIR "/" + file);
    return out;
  }

  enum class Bound { all, some, none }; // State of the optional slots.
  using Visit = std::function<void(const Graph&, const CompiledPlan&, Bound)>;

  void for_each_plan(const Visit& visit) {
    const std::vector<std::string> all = files();
    ASSERT_GE(all.size(), 2u);
    for (const std::string& name : all) {
      SCOPED_TRACE(name);
      Diagnostics diagnostics;
      const auto document = read_document(name, diagnostics);
      ASSERT_TRUE(document);
      const auto graph = read_graph(*document, pass_types, diagnostics);
      ASSERT_TRUE(graph);
      std::vector<size_t> optional;
      for (size_t r = 0; r < graph->resources.size(); ++r)
        if (graph->resources[r].optional) optional.push_back(r);
      for (uint32_t unbound = 0; unbound < 1u << optional.size(); ++unbound) {
        if (!tried(unbound, optional.size())) continue;
        SCOPED_TRACE(unbound);
        CompileInput input;
        input.graph = &*graph;
        input.pass_types = &pass_types;
        input.device = &device;
        input.view_width = 640;
        input.view_height = 360;
        input.bound.assign(graph->resources.size(), true);
        for (size_t i = 0; i < optional.size(); ++i)
          input.bound[optional[i]] = (unbound >> i & 1u) == 0;
        const auto compiled = compile(input, diagnostics);
        ASSERT_TRUE(compiled) << format_as_json(diagnostics);
        const bool none = unbound + 1 == 1u << optional.size();
        visit(*graph, *compiled, unbound == 0 ? Bound::all : none ? Bound::none : Bound::some);
      }
    }
  }
};

TEST_F(ShippedPlans, AreAcceptedByVerifierAndOracle) {
  for_each_plan([](const Graph&, const CompiledPlan& compiled, Bound) {
    EXPECT_EQ(verify(compiled.plan).violations, std::vector<std::string>{});
    EXPECT_EQ(first_hazard(compiled.plan), "");
  });
}

// Returns whether the barrier acquires memory. Buffers that acquire the memory of one resource
// together each have a barrier, and any of these barriers is enough.
bool takes_over_memory(const Plan& plan, uint32_t barrier) {
  const PlanBarrier& one = plan.barriers[barrier];
  return one.why == PlanBarrier::ReasonKind::alias && one.source_access == 0 &&
         one.old_layout == one.new_layout;
}

// Returns the plan without the barriers that acquire memory in the batch of `barrier`.
Plan without_batch_mates(const Plan& plan, uint32_t barrier) {
  Plan out = plan;
  for (const PlanPass& pass : plan.passes)
    for (uint32_t b = pass.first_barrier + pass.barrier_count; b-- > pass.first_barrier;)
      if (barrier >= pass.first_barrier && barrier < pass.first_barrier + pass.barrier_count &&
          takes_over_memory(plan, b))
        out = without_barrier(out, b);
  return out;
}

TEST_F(ShippedPlans, DroppedBarrier_IsRejected) {
  // The full mode visits many plans that differ in few bindings, so it tries every fourth of them.
  uint64_t similar = 0;
  for_each_plan([&](const Graph&, const CompiledPlan& compiled, Bound bound) {
    if (bound == Bound::some && ++similar % seeds_to_try(1, 4) != 0) return;
    for (uint32_t b = 0; b < compiled.plan.barriers.size(); ++b) {
      if (!verify(without_barrier(compiled.plan, b)).violations.empty()) continue;
      EXPECT_TRUE(takes_over_memory(compiled.plan, b)) << "barrier " << b;
      EXPECT_FALSE(verify(without_batch_mates(compiled.plan, b)).violations.empty())
          << "barrier " << b;
    }
  });
}

TEST_F(ShippedPlans, Mutants_AreRejectedIfHazardous) {
  Tally tally;
  for_each_plan([&](const Graph&, const CompiledPlan& compiled, Bound bound) {
    // The oracle is slow: it checks the widest plan of each graph, and in full mode the narrowest,
    // too.
    if (bound != Bound::all && (bound == Bound::some || seeds_to_try(0, 1) == 0)) return;
    for (const auto for_each_mutant :
         {for_each_weaker_mask, for_each_shifted_placement, for_each_flipped_slot, for_each_swap,
          for_each_moved_barrier, for_each_lost_declaration})
      for_each_mutant(compiled.plan, [&](const Plan& mutant, const std::string& what) {
        if (!HasFatalFailure()) expect_same_verdict(mutant, what, tally);
      });
  });
  EXPECT_GT(tally.rejected * 10, tally.tried * 8);
}

TEST_F(ShippedPlans, EveryLegalOrder_GivesTheReferencePixels) {
  for_each_plan([&](const Graph& graph, const CompiledPlan& compiled, Bound bound) {
    const Interpretation recorded = interpret(compiled.plan, {frames, 1, 1, 0});
    if (bound == Bound::all) {
      EXPECT_TRUE(agrees(recorded, graph_reference(graph, pass_types, frames, 1)));
    }
    const uint64_t orders = bound == Bound::some ? seeds_to_try(8, 2) : seeds_to_try(8, 20);
    for (uint64_t seed = 1; seed <= orders; ++seed) {
      EXPECT_EQ(interpret(compiled.plan, {frames, 1, seed, seed}), recorded);
      EXPECT_EQ(interpret(without_aliasing(compiled.plan), {frames, 1, seed, seed}), recorded);
    }
  });
}

} // namespace
