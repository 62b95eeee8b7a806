// Transients reuse the memory of a history instance while the instance holds no live contents.

#include "tests/framegraph/graph_reference.hpp"
#include "tests/framegraph/random_graph.hpp"
#include "tests/framegraph/second_opinion.hpp"
#include "tests/framegraph/test_scale.hpp"

#include "framegraph/compile/packer.hpp"
#include "framegraph/verify/verify.hpp"
#include "tests/support/matchers.hpp"

#include <fmt/format.h>

namespace dermis::testing {
namespace {

bool aliases_history(const Plan& plan, const PlanResource& resource) {
  return resource.first_instance != no_instance &&
         !plan.placements[resource.first_instance].persistent &&
         plan.heaps[plan.placements[resource.first_instance].heap].persistent;
}

const PlanResource& find(const GraphBuilder& b, const Plan& plan, const std::string& name) {
  for (const PlanResource& resource : plan.resources)
    if (resource.declared == b.resource(name)) return resource;
  ADD_FAILURE() << name << " is not in the plan";
  return plan.resources.front();
}

// Size in bytes of the transient heap if no transient were aliased into a history.
uint64_t bytes_without_history_aliasing(const Plan& plan) {
  std::vector<PackItem> items;
  for (const PlanResource& resource : plan.resources) {
    if (resource.first_instance == no_instance) continue;
    const Placement& one = plan.placements[resource.first_instance];
    if (!one.persistent) items.push_back({one.size, one.alignment, one.first_use, one.last_use});
  }
  return pack_items(items).size;
}

// Builds a chain of images that runs before or after the pass that writes the history `sum`. That
// pass reads the oldest of the `frames` earlier frames.
GraphBuilder chain(uint32_t frames, bool after) {
  GraphBuilder b;
  b.import("light");
  b.history("sum", frames);
  b.exported("result");
  const std::string oldest = fmt::format("sum@-{}", frames);
  const std::string first = after ? "sum" : "light";
  if (after) b.pass("accumulate", "test.shade", {{"a", "light"}, {"b", oldest}}, {{"out", "sum"}});
  b.image("one");
  b.image("two");
  b.pass("make one", "test.need", {{"a", first}}, {{"out", "one"}});
  b.pass("make two", "test.need", {{"a", "one"}}, {{"out", "two"}});
  if (!after) b.pass("accumulate", "test.shade", {{"a", "two"}, {"b", oldest}}, {{"out", "sum"}});
  b.pass("show", "test.need", {{"a", after ? "two" : "sum"}}, {{"out", "result"}});
  return b;
}

TEST(HistoryAliasing, AliasesInstanceNotWrittenYet) {
  const GraphBuilder b = chain(1, false);
  const CompiledPlan whole = compiled(b);
  const PlanResource &one = find(b, whole.plan, "one"), &sum = find(b, whole.plan, "sum");
  ASSERT_TRUE(aliases_history(whole.plan, one));
  ASSERT_EQ(one.instance_count, 2u);
  for (uint32_t i = 0; i < 2; ++i) // The instance of this frame.
    EXPECT_EQ(whole.plan.placements[one.first_instance + i].offset,
              whole.plan.placements[sum.first_instance + i].offset);
  EXPECT_LT(whole.plan.transient_bytes, bytes_without_history_aliasing(whole.plan));
  EXPECT_THAT(reasons(b, whole, Reason::About::resource, b.resource("one").value),
              HasSubstr("memory of the history 'sum'"));
}

TEST(HistoryAliasing, AliasesInstanceAfterItsLastRead) {
  for (const uint32_t frames : {1u, 2u, 3u}) {
    const GraphBuilder b = chain(frames, true);
    const Plan plan = compiled(b).plan;
    const PlanResource &one = find(b, plan, "one"), &sum = find(b, plan, "sum");
    ASSERT_TRUE(aliases_history(plan, one));
    ASSERT_EQ(one.instance_count, frames + 1);
    for (uint32_t i = 0; i < one.instance_count; ++i) // The instance of the next frame.
      EXPECT_EQ(plan.placements[one.first_instance + i].offset,
                plan.placements[sum.first_instance + (i + 1) % sum.instance_count].offset);
  }
}

TEST(HistoryAliasing, NoAliasing_OptionOffOrKeptAlive) {
  const GraphBuilder b = chain(1, false);
  CompileInput input = b.input();
  input.alias = false;
  EXPECT_FALSE(aliases_history(compiled(b, input).plan, find(b, compiled(b, input).plan, "one")));
  input.alias = true;
  input.keep_alive = b.resource("sum");
  const Plan kept = compiled(b, input).plan;
  for (const PlanResource& resource : kept.resources)
    EXPECT_FALSE(aliases_history(kept, resource));
}

TEST(HistoryAliasing, Verifier_WrongInstance_IsRejected) {
  for (const bool after : {false, true})
    for (const uint32_t frames : {1u, 2u, 3u}) {
      const GraphBuilder b = chain(frames, after);
      const Plan plan = compiled(b).plan;
      Tally tally;
      for (const PlanResource& resource : plan.resources) {
        if (!aliases_history(plan, resource)) continue;
        for (uint32_t turn = 1; turn < resource.instance_count; ++turn) {
          Plan mutant = plan;
          for (uint32_t i = 0; i < resource.instance_count; ++i)
            mutant.placements[resource.first_instance + i].offset =
                plan.placements[resource.first_instance + (i + turn) % resource.instance_count]
                    .offset;
          expect_same_verdict(mutant, fmt::format("{} frames, turned by {}", frames, turn), tally);
        }
      }
      EXPECT_GT(tally.tried, 0u);
      EXPECT_GT(tally.rejected, 0u);
    }
}

TEST(HistoryAliasing, RandomGraphs_SaveMemoryWithEqualPixels) {
  constexpr uint32_t frames = 9; // Each of up to four instances is aliased twice.
  uint64_t with = 0, without = 0, aliased_resources = 0;
  for (uint64_t seed = 0; seed < seeds_to_try(1500, 10000); ++seed) {
    const GraphBuilder b = random_graph(seed);
    const Plan plan = compiled(b).plan; // compiled() also runs the verifier.
    uint64_t here = 0;
    for (const PlanResource& resource : plan.resources)
      here += aliases_history(plan, resource);
    if (here == 0) continue;
    aliased_resources += here;
    with += plan.transient_bytes;
    without += bytes_without_history_aliasing(plan);
    const Interpretation reference = graph_reference(b.graph, b.pass_types, frames, seed);
    for (uint64_t order = 0; order < 3; ++order)
      ASSERT_TRUE(agrees(interpret(plan, {frames, seed, order + 1, order, 0}), reference))
          << "seed " << seed;
  }
  RecordProperty("aliased_resources", std::to_string(aliased_resources));
  RecordProperty("transient_bytes", std::to_string(with));
  RecordProperty("transient_bytes_without_aliasing", std::to_string(without));
  EXPECT_GT(aliased_resources, 100u);
  EXPECT_LT(with, without);
}

} // namespace
} // namespace dermis::testing
