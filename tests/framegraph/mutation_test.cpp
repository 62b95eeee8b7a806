// Mutation tests: the verifier rejects a modified plan exactly when the exhaustive oracle finds a
// hazard.

#include "tests/framegraph/graph_reference.hpp"
#include "tests/framegraph/hazard_oracle.hpp"
#include "tests/framegraph/plan_mutations.hpp"
#include "tests/framegraph/random_graph.hpp"
#include "tests/framegraph/second_opinion.hpp"
#include "tests/framegraph/test_scale.hpp"

#include "framegraph/verify/verify.hpp"

#include <gtest/gtest.h>

#include <fmt/format.h>

namespace dermis::testing {
namespace {

template <class Visit> void for_random_plans(uint64_t quick, uint64_t full, Visit visit) {
  for (uint64_t seed = 0; seed < seeds_to_try(quick, full) && !::testing::Test::HasFailure();
       ++seed) {
    const auto builder = random_graph(seed);
    const Plan plan = compiled(builder).plan;
    visit(builder, plan, seed);
  }
}

using ForEachMutant = void (*)(const Plan&, const VisitMutant&);

Tally compare_verdicts(uint64_t quick, uint64_t full, ForEachMutant for_each_mutant) {
  Tally tally;
  for_random_plans(quick, full, [&](const GraphBuilder&, const Plan& plan, uint64_t seed) {
    for_each_mutant(plan, [&](const Plan& mutant, const std::string& what) {
      if (!::testing::Test::HasFatalFailure())
        expect_same_verdict(mutant, fmt::format("seed {}: {}", seed, what), tally);
    });
  });
  return tally;
}

TEST(Mutation, OracleAcceptsCompiledPlans) {
  for_random_plans(300, 3000, [](const GraphBuilder&, const Plan& plan, uint64_t seed) {
    EXPECT_EQ(first_hazard(plan), "") << "seed " << seed;
  });
}

TEST(Mutation, DroppedBarrier_IsRejected) {
  uint64_t dropped = 0;
  for_random_plans(1000, 5000, [&](const GraphBuilder&, const Plan& plan, uint64_t seed) {
    for (uint32_t b = 0; b < plan.barriers.size(); ++b, ++dropped)
      ASSERT_FALSE(verify(without_barrier(plan, b)).violations.empty())
          << "seed " << seed << ", barrier " << b;
  });
  EXPECT_GT(dropped, 10000u);
}

TEST(Mutation, DiscardedContents_AreRejected) {
  uint64_t discarded = 0;
  for_random_plans(300, 3000, [&](const GraphBuilder&, const Plan& plan, uint64_t seed) {
    for (uint32_t b = 0; b < plan.barriers.size(); ++b) {
      const PlanBarrier& barrier = plan.barriers[b];
      const PlanResource& resource = plan.resources[barrier.resource];
      // A frame may discard the oldest frame of a history, which it overwrites, and mips that no
      // pass has written yet.
      const bool discardable = resource.mips > 1 || resource.layers > 1 ||
                               (resource.instance_count > 1 && barrier.frames_back == 0);
      if (resource.type != ResourceType::image || discardable || barrier.from_host ||
          barrier.old_layout == Layout::undefined)
        continue;
      Plan mutant = plan;
      mutant.barriers[b].old_layout = Layout::undefined;
      ++discarded;
      ASSERT_FALSE(verify(mutant).violations.empty()) << "seed " << seed << ", barrier " << b;
    }
  });
  EXPECT_GT(discarded, 1000u);
}

// Alias barriers name the accesses of every earlier occupant, including those that a later occupant
// waited for. Few other masks may be wider than necessary.
TEST(Mutation, WeakerMask_IsRejectedIfHazardous) {
  const Tally tally = compare_verdicts(60, 600, for_each_weaker_mask);
  EXPECT_GT(tally.rejected * 20, tally.tried * 19);
}

TEST(Mutation, MovedPlacement_IsRejectedIfHazardous) {
  const Tally tally = compare_verdicts(150, 1500, for_each_shifted_placement);
  EXPECT_GT(tally.rejected * 10, tally.tried * 9);
}

TEST(Mutation, LostAliasDependency_IsRejected) {
  uint64_t lost = 0;
  for_random_plans(1000, 5000, [&](const GraphBuilder&, const Plan& plan, uint64_t seed) {
    for (uint32_t b = 0; b < plan.barriers.size(); ++b) {
      if (plan.barriers[b].why != PlanBarrier::ReasonKind::alias) continue;
      Plan mutant = plan;
      mutant.barriers[b].source_stages = stage::none;
      mutant.barriers[b].source_access = access::none;
      ASSERT_FALSE(verify(mutant).violations.empty()) << "seed " << seed << ", barrier " << b;
      ++lost;
    }
  });
  EXPECT_GT(lost, 1000u);
}

// A flip may be free of hazards if both slots hold older frames, but the pass still reads the wrong
// frame. The pixels show that after the difference has passed through all histories to the host.
// The exception is a flip that only leads to a placeholder, which is read while all histories are
// zero.
TEST(Mutation, FlippedHistorySlot_IsRejectedOrChangesPixels) {
  constexpr uint32_t frames = 14;
  Tally tally;
  for_random_plans(300, 3000, [&](const GraphBuilder& builder, const Plan& plan, uint64_t seed) {
    if (std::any_of(plan.accesses.begin(), plan.accesses.end(), [](const PlanAccess& access) {
          return access.when == ReadWhen::history_invalid;
        }))
      return;
    const Interpretation reference =
        graph_reference(builder.graph, builder.pass_types, frames, seed);
    for_each_flipped_slot(plan, [&](const Plan& mutant, const std::string& what) {
      if (HasFatalFailure()) return;
      expect_same_verdict(mutant, fmt::format("seed {}: {}", seed, what), tally);
      if (verify(mutant).violations.empty()) {
        EXPECT_FALSE(agrees(interpret(mutant, {frames, seed, 1, 0}), reference))
            << "seed " << seed << ": " << what;
      }
    });
  });
  EXPECT_GT(tally.rejected, 100u);
  EXPECT_GT(tally.tried, tally.rejected);
}

// The declaration does not matter for a history whose frames have separate memory.
TEST(Mutation, LostDeclaration_IsRejectedIfHazardous) {
  const Tally tally = compare_verdicts(300, 3000, for_each_lost_declaration);
  EXPECT_GT(tally.rejected, 30u);
  EXPECT_GT(tally.tried, tally.rejected);
}

TEST(Mutation, RedirectedAccess_IsRejectedIfHazardous) {
  const Tally tally = compare_verdicts(60, 600, for_each_redirected_access);
  EXPECT_GT(tally.rejected, 500u);
}

TEST(Mutation, SwappedPasses_AreRejectedIfHazardous) {
  const Tally tally = compare_verdicts(150, 1500, for_each_swap);
  EXPECT_GT(tally.rejected, 100u);
  EXPECT_GT(tally.tried, tally.rejected); // Some neighbouring passes are independent.
}

TEST(Mutation, MovedBarrier_IsRejectedIfHazardous) {
  const Tally tally = compare_verdicts(60, 600, for_each_moved_barrier);
  EXPECT_GT(tally.rejected, 100u);
  EXPECT_GT(tally.tried, tally.rejected); // Some barriers wait for work that ended long before.
}

} // namespace
} // namespace dermis::testing
