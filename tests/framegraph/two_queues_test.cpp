// Tests plans with an async queue: all cross-queue dependencies are kept, no wait is redundant, and
// every order that the semaphore points allow gives equal pixels.

#include "tests/framegraph/graph_reference.hpp"
#include "tests/framegraph/hazard_oracle.hpp"
#include "tests/framegraph/plan_mutations.hpp"
#include "tests/framegraph/random_graph.hpp"
#include "tests/framegraph/second_opinion.hpp"
#include "tests/framegraph/test_scale.hpp"

#include "framegraph/serialize/plan_file.hpp"
#include "framegraph/verify/verify.hpp"
#include "tests/framegraph/interpret/commands.hpp"
#include "tests/support/matchers.hpp"

#include <fmt/format.h>

#include <map>
#include <utility>

namespace dermis::testing {
namespace {

constexpr uint32_t queue_frames = 5;

CompileInput two_queues(const GraphBuilder& builder) {
  CompileInput input = builder.input();
  input.single_queue = false;
  return input;
}

uint32_t async_passes(const Plan& plan) {
  uint32_t count = 0;
  for (const PlanPass& pass : plan.passes)
    count += pass.queue == Queue::async;
  return count;
}

template <class Visit>
void for_random_plans(uint64_t quick, uint64_t full, Visit visit, Sizes sizes = Sizes::mixed) {
  for (uint64_t seed = 0; seed < seeds_to_try(quick, full) && !::testing::Test::HasFailure();
       ++seed) {
    auto builder = random_graph(seed, sizes);
    if (seed % 4 == 1) draw_orders(builder, seed);
    const Plan plan = compiled(builder, two_queues(builder)).plan;
    if (async_passes(plan) > 0) visit(builder, plan, seed);
  }
}

// Builds light -> a -> (async) b -> c, and a -> d in parallel.
GraphBuilder fork() {
  GraphBuilder b;
  b.import("light");
  for (const char* name : {"a", "b", "c", "d"})
    b.image(name);
  b.exported("result");
  b.pass("first", "test.need", {{"a", "light"}}, {{"out", "a"}});
  b.pass("aside", "test.need", {{"a", "a"}}, {{"out", "b"}}).async = true;
  b.pass("beside", "test.need", {{"a", "light"}}, {{"out", "d"}});
  b.pass("join", "test.shade", {{"a", "b"}, {"b", "d"}}, {{"out", "result"}});
  return b;
}

TEST(TwoQueues, ForkAndJoinTakeOnePointEach) {
  const auto b = fork();
  CompileInput input = two_queues(b);
  input.alias = false; // Aliased memory can also make a queue wait for the other.
  const auto whole = compiled(b, input);
  const Plan& plan = whole.plan;
  ASSERT_EQ(pass_names(b, plan), "first aside beside join");
  EXPECT_EQ(plan.passes[1].queue, Queue::async);
  EXPECT_EQ(plan.passes[0].signal, 1u);
  EXPECT_EQ(plan.passes[0].release_count, 1u);
  EXPECT_EQ(plan.passes[1].wait, 1u);
  EXPECT_EQ(plan.passes[1].signal, 1u);
  EXPECT_EQ(plan.passes[2].wait, no_point);
  EXPECT_EQ(plan.passes[3].wait, 1u);
  EXPECT_THAT(reasons(b, whole, Reason::About::pass, 1), HasSubstr("runs on the async queue"));
}

TEST(TwoQueues, ASingleQueueIsTheDefault) {
  const auto b = fork();
  EXPECT_EQ(async_passes(compiled(b).plan), 0u);
  const Plan one = compiled(b).plan;
  for (const PlanBarrier& barrier : one.barriers)
    EXPECT_EQ(barrier.transfer, PlanBarrier::Transfer::none);
}

TEST(TwoQueues, HostResourcesStayOnTheMainQueue) {
  auto b = fork();
  b.graph.passes[0].async = true;
  const auto whole = compiled(b, two_queues(b));
  EXPECT_EQ(whole.plan.passes[0].queue, Queue::main);
  EXPECT_THAT(reasons(b, whole, Reason::About::pass, 0),
              HasSubstr("runs on the main queue: 'light'"));
}

TEST(TwoQueues, AfterIsAPointBetweenPassesOfTwoQueues) {
  auto b = fork();
  b.graph.passes[2].after.push_back({PassId{1}, "the probe is to see it finished", {}});
  CompileInput input = two_queues(b);
  input.alias = false;
  const auto whole = compiled(b, input);
  ASSERT_EQ(pass_names(b, whole.plan), "first aside beside join");
  EXPECT_EQ(whole.plan.passes[2].wait, 1u);
  EXPECT_EQ(whole.plan.passes[3].wait, no_point); // The pass has waited already.
  EXPECT_THAT(reasons(b, whole, Reason::About::pass, 2),
              HasSubstr("runs after 'aside': the probe is to see it finished"));
  Plan mutant = whole.plan;
  mutant.passes[3].wait =
      // Nothing of `aside` is needed before this pass.
      std::exchange(mutant.passes[2].wait, no_point);
  EXPECT_THAT(verify(mutant).violations.front(),
              HasSubstr("pass 2: does not run after pass 1, as the graph requires"));
  EXPECT_NE(first_hazard(mutant), "");
}

TEST(TwoQueues, AfterIsNoPointBetweenPassesOfOneQueue) {
  auto b = fork();
  b.graph.passes[2].after.push_back({PassId{1}, "the probe is to see it finished", {}});
  const Plan plan = compiled(b).plan;
  EXPECT_EQ(plan.passes[2].wait, no_point);
  ASSERT_EQ(plan.orderings.size(), 1u);
  Plan mutant = plan;
  std::swap(mutant.orderings[0].earlier, mutant.orderings[0].later);
  EXPECT_THAT(verify(mutant).violations.front(), HasSubstr("does not run after"));
  EXPECT_NE(first_hazard(mutant), "");
}

TEST(TwoQueues, EveryLegalOrder_KeepsAfter) {
  uint64_t kept = 0;
  for (uint64_t seed = 0; seed < seeds_to_try(400, 4000); ++seed) {
    auto builder = random_graph(seed);
    draw_orders(builder, seed);
    const Plan plan = compiled(builder, two_queues(builder)).plan;
    const std::vector<Command> commands = record(plan, 0, 3);
    for (uint64_t order = 1; order <= 3; ++order) {
      // Maps (frame, position in the plan) to the position in the order.
      std::map<std::pair<uint32_t, uint32_t>, size_t> place;
      for (const uint32_t c : legal_order(plan, memory_of(plan), commands, order))
        if (commands[c].is_pass && commands[c].wait_until == no_wait)
          place.emplace(std::pair(commands[c].frame, commands[c].index), place.size());
      for (const PlanOrdering& one : plan.orderings)
        for (uint32_t frame = 0; frame < 3; ++frame) {
          if (plan.passes[one.earlier].queue == plan.passes[one.later].queue) continue;
          ASSERT_LT(place.at({frame, one.earlier}), place.at({frame, one.later}))
              << "seed " << seed;
          ++kept;
        }
    }
  }
  EXPECT_GT(kept, 300u);
}

TEST(TwoQueues, OracleAcceptsCompiledPlans) {
  uint64_t transfers = 0;
  for_random_plans(300, 3000, [&](const GraphBuilder&, const Plan& plan, uint64_t seed) {
    EXPECT_EQ(first_hazard(plan), "") << "seed " << seed;
    for (const PlanBarrier& barrier : plan.barriers)
      transfers += barrier.transfer == PlanBarrier::Transfer::acquire;
  });
  EXPECT_GT(transfers, 100u);
}

// Two passes of the async queue wait for the previous frame, and the second needs a later point.
// compiled() runs the verifier. These seeds generate the case.
TEST(TwoQueues, WaitsForPreviousFrame_CoverEveryPass) {
  for (const uint64_t seed : {2642u, 4607u, 4977u}) {
    const auto builder = random_graph(seed, Sizes::one_page);
    EXPECT_GT(async_passes(compiled(builder, two_queues(builder)).plan), 0u) << "seed " << seed;
  }
}

TEST(TwoQueues, EveryLegalOrder_GivesTheReferencePixels) {
  for_random_plans(1500, 10000, [&](const GraphBuilder& builder, const Plan& plan, uint64_t seed) {
    const Interpretation reference =
        graph_reference(builder.graph, builder.pass_types, queue_frames, seed);
    for (uint64_t order = 0; order <= 3; ++order)
      ASSERT_TRUE(agrees(interpret(plan, {queue_frames, seed, order + 1, order}), reference))
          << "seed " << seed << ", order " << order;
  });
}

void expect_no_needless_barrier(const Plan& plan, uint64_t seed) {
  for (uint32_t b = 0; b < plan.barriers.size(); ++b)
    EXPECT_FALSE(verify(without_barrier(plan, b)).violations.empty())
        << "seed " << seed << ": without barrier " << b;
}

// A later pass reads a buffer with another usage, after a pass whose wait made the buffer visible.
// These seeds generate the case.
TEST(TwoQueues, VisibleByAWait_NeedsNoBarrierForOtherUsages) {
  for (const uint64_t seed : {25505u, 34848u, 73763u}) {
    const auto builder = random_graph(seed, Sizes::one_page);
    expect_no_needless_barrier(compiled(builder, two_queues(builder)).plan, seed);
  }
  for (const uint64_t seed : {21952u, 45182u, 75141u}) {
    const auto builder = random_graph(seed, Sizes::mixed);
    expect_no_needless_barrier(compiled(builder, two_queues(builder)).plan, seed);
  }
}

// Each mutant is rejected: by the verifier in every plan, and by the oracle in the first
// `judged_twice` plans.
template <class ForEachMutant>
void expect_none_needless(uint64_t judged_twice, uint64_t quick, uint64_t full, uint64_t minimum,
                          ForEachMutant for_each_mutant) {
  uint64_t dropped = 0;
  for (const Sizes sizes : {Sizes::one_page, Sizes::mixed})
    for_random_plans(
        quick, full,
        [&](const GraphBuilder&, const Plan& plan, uint64_t seed) {
          for_each_mutant(plan, [&](const Plan& mutant, const std::string& what) {
            ++dropped;
            EXPECT_FALSE(verify(mutant).violations.empty()) << "seed " << seed << ": " << what;
            if (seed < judged_twice) {
              EXPECT_NE(first_hazard(mutant), "") << "seed " << seed << ": " << what;
            }
          });
        },
        sizes);
  EXPECT_GT(dropped, minimum);
}

TEST(TwoQueues, DroppedBarrierOrHalfTransfer_IsRejected) {
  expect_none_needless(100, 1000, 10000, 10000, [](const Plan& plan, const VisitMutant& visit) {
    for (uint32_t b = 0; b < plan.barriers.size(); ++b)
      visit(without_barrier(plan, b), fmt::format("without barrier {}", b));
  });
}

TEST(TwoQueues, LostOrEarlierWaitOrSignal_IsRejected) {
  expect_none_needless(300, 1000, 10000, 2000, for_each_lost_point);
}

TEST(TwoQueues, WeakerMask_IsRejectedIfHazardous) {
  Tally tally;
  for_random_plans(60, 600, [&](const GraphBuilder&, const Plan& plan, uint64_t seed) {
    for_each_weaker_mask(plan, [&](const Plan& mutant, const std::string& what) {
      if (!HasFatalFailure())
        expect_same_verdict(mutant, fmt::format("seed {}: {}", seed, what), tally);
    });
  });
  EXPECT_GT(tally.rejected, 100u);
}

TEST(TwoQueues, PassOnTheOtherQueue_IsRejectedIfHazardous) {
  Tally tally;
  for_random_plans(150, 1500, [&](const GraphBuilder&, const Plan& plan, uint64_t seed) {
    for (size_t p = 0; p < plan.passes.size() && !HasFatalFailure(); ++p) {
      Plan mutant = plan;
      mutant.passes[p].queue = plan.passes[p].queue == Queue::main ? Queue::async : Queue::main;
      expect_same_verdict(mutant, fmt::format("seed {}: pass {}", seed, p), tally);
    }
  });
  EXPECT_GT(tally.rejected, 100u);
}

TEST(TwoQueues, AreSavedAndReadBack) {
  const auto b = fork();
  const CompileInput input = two_queues(b);
  const SavedPlan saved = saved_plan(input, compiled(b, input).plan);
  Diagnostics diagnostics;
  const auto again = read_plan("a.plan", write_plan(saved), diagnostics);
  ASSERT_TRUE(again);
  EXPECT_EQ(write_plan(*again), write_plan(saved));
  EXPECT_EQ(async_passes(again->plan), 1u);
}

} // namespace
} // namespace dermis::testing
