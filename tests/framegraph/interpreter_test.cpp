// Metamorphic properties: whatever the compiler may choose, the host gets equal pixels, and they
// match the graph's declarations.

#include "tests/framegraph/graph_reference.hpp"
#include "tests/framegraph/plan_mutations.hpp"
#include "tests/framegraph/random_graph.hpp"
#include "tests/framegraph/test_scale.hpp"

#include "framegraph/verify/verify.hpp"

#include <gtest/gtest.h>

namespace dermis::testing {
namespace {

constexpr uint32_t frames = 5; // Each of up to four history instances is reused.
constexpr uint64_t orders = 3; // Number of orders tried per plan.

uint64_t random_graphs() {
  return seeds_to_try(1500, 10000);
}

InterpretOptions options(uint64_t contents, uint64_t poison = 1, uint64_t order = 0) {
  return {frames, contents, poison, order};
}

// Makes some unread exports optional and unbound, chosen by the seed. The passes that only they
// need are culled.
std::vector<bool> leave_out_exports(GraphBuilder& builder, uint64_t seed) {
  std::vector<bool> bound(builder.graph.resources.size(), true);
  for (uint32_t r = 0; r < builder.graph.resources.size(); ++r) {
    ResourceDeclaration& resource = builder.graph.resources[r];
    if (!resource.exported || resource.origin == Origin::imported || r % 2 != seed % 2) continue;
    resource.optional = true;
    bound[r] = false;
  }
  return bound;
}

// Adds a pass with side effects that reads every image, so that every pass that writes an image is
// live.
GraphBuilder with_all_images_needed(GraphBuilder builder) {
  const size_t resources = builder.graph.resources.size();
  for (size_t r = 0; r < resources; ++r)
    if (builder.graph.resources[r].type == ResourceType::image) {
      const std::string name = builder.graph.resources[r].name;
      builder.pass("needs_" + name, "test.probe", {{"a", name}}, {});
    }
  return builder;
}

TEST(Interpreter, EveryPlanGivesTheReferencePixels) {
  uint64_t compared = 0;
  for (uint64_t seed = 0; seed < random_graphs(); ++seed) {
    const auto builder = random_graph(seed);
    const Interpretation reference =
        graph_reference(builder.graph, builder.pass_types, frames, seed);
    ASSERT_TRUE(agrees(interpret(compiled(builder).plan, options(seed)), reference))
        << "seed " << seed;
    for (const auto& slot : reference.back())
      compared += slot.has_value();
  }
  EXPECT_GT(compared, random_graphs()); // Every graph has at least one export.
}

// Cuts change which histories are valid, and so what passes read; the plan stays the same.
TEST(Interpreter, CutsChangeOnlyWhatIsRead) {
  uint64_t conditional = 0, changed = 0;
  for (uint64_t seed = 0; seed < random_graphs(); ++seed) {
    const auto builder = random_graph(seed);
    const Plan plan = compiled(builder).plan;
    const uint64_t cuts = (seed % 31 + 1) << 1u; // Every set of the frames 1 .. 4.
    const Interpretation reference =
        graph_reference(builder.graph, builder.pass_types, frames, seed, cuts);
    InterpretOptions with_cuts = options(seed, seed, seed % orders);
    with_cuts.cuts = cuts;
    ASSERT_TRUE(agrees(interpret(plan, with_cuts), reference)) << "seed " << seed;
    changed += !agrees(interpret(plan, options(seed)), reference);
    for (const PlanAccess& access : plan.accesses)
      conditional += access.when != ReadWhen::always;
  }
  EXPECT_GT(conditional, random_graphs() / 4);
  EXPECT_GT(changed, random_graphs() / 4);
}

TEST(Interpreter, LegalOrdersAndUndefinedContentsChangeNothing) {
  uint64_t moved = 0;
  for (uint64_t seed = 0; seed < random_graphs(); ++seed) {
    const auto builder = random_graph(seed);
    const Plan plan = compiled(builder).plan;
    const Interpretation reference =
        graph_reference(builder.graph, builder.pass_types, frames, seed);
    for (uint64_t order = 1; order <= orders; ++order)
      ASSERT_TRUE(agrees(interpret(plan, options(seed, order, order)), reference))
          << "seed " << seed << ", order " << order;
    moved += plan.passes.size() > 2;
  }
  EXPECT_GT(moved, random_graphs() / 2);
}

TEST(Interpreter, SeparateMemoryChangesNothing) {
  uint64_t shared = 0;
  for (uint64_t seed = 0; seed < random_graphs(); ++seed) {
    const auto builder = random_graph(seed);
    const Plan plan = compiled(builder).plan;
    const Plan apart = without_aliasing(plan);
    const Interpretation reference =
        graph_reference(builder.graph, builder.pass_types, frames, seed);
    ASSERT_TRUE(agrees(interpret(apart, options(seed, 2, seed + 1)), reference)) << "seed " << seed;
    for (size_t h = 0; h < plan.heaps.size(); ++h)
      shared += apart.heaps[h].size > plan.heaps[h].size;
  }
  EXPECT_GT(shared, random_graphs() / 4); // Many of the plans have to share memory.
}

TEST(Interpreter, CullingChangesNothingForTheHost) {
  uint64_t fewer = 0, more = 0;
  for (uint64_t seed = 0; seed < random_graphs(); ++seed) {
    GraphBuilder builder = random_graph(seed);
    const Interpretation reference =
        graph_reference(builder.graph, builder.pass_types, frames, seed);
    const size_t passes = compiled(builder).plan.passes.size();

    const auto all = with_all_images_needed(builder);
    const Plan uncut = compiled(all).plan;
    ASSERT_TRUE(agrees(interpret(uncut, options(seed, 1, seed + 1)), reference)) << "seed " << seed;
    more += uncut.passes.size() > passes + all.graph.passes.size() - builder.graph.passes.size();

    const std::vector<bool> bound = leave_out_exports(builder, seed);
    CompileInput input = builder.input();
    input.bound = bound;
    const Plan cut = compiled(builder, input).plan;
    Interpretation expected = reference;
    const Interpretation found = interpret(cut, options(seed, 1, seed + 1));
    for (size_t frame = 0; frame < frames; ++frame)
      for (size_t slot = 0; slot < expected[frame].size(); ++slot)
        if (slot >= found[frame].size() || !found[frame][slot]) expected[frame][slot].reset();
    // Only the unbound exports may be missing.
    for (size_t r = 0, slot = 0; r < bound.size(); ++r) {
      const ResourceDeclaration& resource = builder.graph.resources[r];
      if (resource.origin != Origin::imported && !resource.exported) continue;
      if (bound[r]) {
        ASSERT_EQ(expected[0][slot].has_value(), reference[0][slot].has_value()) << "seed " << seed;
      }
      ++slot;
    }
    ASSERT_TRUE(agrees(found, expected)) << "seed " << seed;
    fewer += cut.passes.size() < passes;
  }
  EXPECT_GT(fewer, random_graphs() / 8);
  EXPECT_GT(more, random_graphs() / 8);
}

// Checks that the interpreter detects missing barriers. The test drops all barriers of a pass at
// once and shares no memory, because one barrier may order the pass after the writers of all its
// inputs. A few passes still wait for the writers through a third pass.
TEST(Interpreter, PixelsChange_WithoutBarriersOfAPass) {
  constexpr uint64_t tries = 16; // Orders of each plan.
  uint64_t dropped = 0, noticed = 0;
  for (uint64_t seed = 0; seed < seeds_to_try(60, 300); ++seed) {
    const auto builder = random_graph(seed);
    const Plan plan = without_aliasing(compiled(builder).plan);
    const Interpretation reference =
        graph_reference(builder.graph, builder.pass_types, frames, seed);
    for (const PlanPass& pass : plan.passes) {
      Plan mutant = plan;
      bool reads = false;
      for (uint32_t b = pass.first_barrier; b < pass.first_barrier + pass.barrier_count; ++b) {
        PlanBarrier& barrier = mutant.barriers[b];
        if (barrier.why != PlanBarrier::ReasonKind::read_after_write) continue;
        barrier.source_stages = stage::host;
        barrier.destination_stages = stage::host;
        reads = true;
      }
      bool seen = false;
      for (uint64_t order = 1; reads && order <= tries && !seen; ++order)
        seen = !agrees(interpret(mutant, options(seed, order, order)), reference);
      dropped += reads;
      noticed += seen;
    }
  }
  EXPECT_GT(dropped, 100u);
  EXPECT_GT(noticed * 20, dropped * 19);
}

TEST(Interpreter, PixelsChange_LiveMemoryIsShared) {
  uint64_t moved = 0, noticed = 0;
  for (uint64_t seed = 0; seed < seeds_to_try(100, 1000); ++seed) {
    const auto builder = random_graph(seed);
    Plan plan = compiled(builder).plan;
    const Interpretation reference =
        graph_reference(builder.graph, builder.pass_types, frames, seed);
    for (Placement& placement : plan.placements)
      placement.offset = 0;
    if (verify(plan).violations.empty()) continue;
    ++moved;
    noticed += !agrees(interpret(plan, options(seed)), reference);
  }
  EXPECT_GT(moved, 10u);
  EXPECT_GT(noticed * 10, moved * 9);
}

} // namespace
} // namespace dermis::testing
