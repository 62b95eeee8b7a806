// The verifier rejects wrong plans: each mutation breaks one property of an accepted plan.

#include "framegraph/verify/verify.hpp"

#include "tests/framegraph/random_graph.hpp"
#include "tests/support/matchers.hpp"

#include <functional>

namespace dermis::testing {
namespace {

constexpr uint64_t verified_graphs = 150;

// Builds a graph with a history, an alias, a buffer read at two stages, and an import updated in
// place.
GraphBuilder everything() {
  GraphBuilder b{"in_out light", "history sum", "buffer tiles"};
  for (const char* name : {"one", "two", "three"})
    b.image(name);
  b.exported("result");
  b.pass("list", "test.list", {{"a", "light"}}, {{"tiles", "tiles"}});
  b.pass("scatter", "test.tiles", {{"tiles", "tiles"}, {"arguments", "tiles"}, {"a", "light"}},
         {{"out", "one"}});
  b.pass("blur", "test.need", {{"a", "one"}}, {{"out", "two"}});
  b.pass("again", "test.need", {{"a", "two"}}, {{"out", "three"}});
  b.pass("accumulate", "test.shade", {{"a", "three"}, {"b", "sum@-1"}}, {{"out", "sum"}});
  b.pass("add", "test.update", {{"a", "sum"}}, {{"image", "light"}});
  b.pass("show", "test.need", {{"a", "sum@-1"}}, {{"out", "result"}});
  return b;
}

void expect_rejected(const std::function<void(Plan&)>& mutate, const std::string& record_reason) {
  const auto b = everything();
  Plan plan = compiled(b).plan;
  mutate(plan);
  EXPECT_THAT(verify(plan).violations, Contains(HasSubstr(record_reason)));
}

TEST(Verify, AcceptsCompiledPlans) {
  const auto b = everything();
  EXPECT_TRUE(verify(compiled(b).plan).proven());
}

TEST(Verify, RejectsAliasedLiveMemory) {
  expect_rejected(
      [](Plan& plan) {
        for (Placement& placement : plan.placements)
          placement.offset = 0;
      },
      "alive at the same time overlap");
}

// Each placement is alive in only one pass, and all placements use the same bytes.
TEST(Verify, ThousandsOfPlacementsInTheSameBytes_GetAVerdict) {
  const auto b = everything();
  Plan plan = compiled(b).plan;
  const auto transient =
      std::find_if(plan.placements.begin(), plan.placements.end(),
                   [](const Placement& placement) { return !placement.persistent; });
  ASSERT_NE(transient, plan.placements.end());
  const PlanResource like = plan.resources[transient->resource];
  Placement placement = *transient;
  for (uint32_t i = 0; i < 9000; ++i) {
    placement.resource = static_cast<uint32_t>(plan.resources.size());
    placement.first_use = placement.last_use = static_cast<uint32_t>(plan.passes.size());
    plan.resources.push_back(like);
    plan.resources.back().first_instance = static_cast<uint32_t>(plan.placements.size());
    plan.placements.push_back(placement);
    plan.passes.push_back({});
  }
  EXPECT_TRUE(verify(plan).proven());
  plan.placements.back().first_use = plan.placements.back().last_use - 1;
  EXPECT_THAT(verify(plan).violations, Contains(HasSubstr("alive at the same time overlap")));
}

// Builds the longest chain that a graph may have. All images use the same memory, one pass each.
GraphBuilder chain(bool equal_sizes, bool forward, uint32_t mips) {
  constexpr uint32_t count = 4000;
  GraphBuilder b;
  b.import("in");
  for (uint32_t i = 0; i < count; ++i) {
    ResourceDeclaration& image =
        i + 1 == count ? b.exported("out") : b.image("r" + std::to_string(i));
    if (i + 1 == count) break;
    image.mips = mips;
    if (equal_sizes) continue;
    image.size.base = SizeExpression::Base::fixed;
    image.size.x = {64 + i % 777, 1};
    image.size.y = {64 + i % 555, 1};
  }
  for (uint32_t k = 0; k < count; ++k) {
    const uint32_t i = forward ? k : count - 1 - k;
    const std::string number = std::to_string(i), before = "r" + std::to_string(i - 1);
    const std::string first = i == 0 ? "in" : before, last = i + 1 == count ? "out" : "r" + number;
    if (mips == 1 || i + 1 == count)
      b.pass("p" + number, "test.shade", {{"a", first}, {"b", "in"}}, {{"out", last}});
    else
      b.pass("p" + number, "test.shade", {{"a", first}, {"b", "in"}},
             {{"out", last + "#0"}, {"out2", last + "#1"}});
  }
  return b;
}

// compiled() runs the verifier, which gives up if its time grows with the square of the number of
// passes.
TEST(Verify, LongestChains_GetAVerdict) {
  for (const bool equal_sizes : {true, false})
    for (const bool forward : {true, false}) {
      const auto b = chain(equal_sizes, forward, 1);
      EXPECT_EQ(compiled(b).plan.passes.size(), 4000u);
    }
  const auto in_parts = chain(false, true, 2);
  EXPECT_EQ(compiled(in_parts).plan.passes.size(), 4000u);
}

// Each of many images is divided into the maximum number of subresources.
TEST(Verify, ExcessiveWork_GivesUpWithoutViolations) {
  const auto b = everything();
  Plan plan = compiled(b).plan;
  for (uint32_t i = 0; i < 20; ++i) {
    const auto resource = static_cast<uint32_t>(plan.resources.size());
    PlanResource image = plan.resources[0];
    image.origin = Origin::transient;
    image.exported = false;
    image.mips = 31;
    image.layers = 2048;
    image.instance_count = 1;
    image.first_instance = static_cast<uint32_t>(plan.placements.size());
    Placement placement = plan.placements[0];
    placement.resource = resource;
    placement.heap = static_cast<uint32_t>(plan.heaps.size());
    placement.offset = 0;
    placement.persistent = false;
    Heap heap = plan.heaps[0];
    heap.size = placement.size;
    plan.heaps.push_back(heap);
    plan.resources.push_back(image);
    plan.placements.push_back(placement);
    PlanBarrier barrier;
    barrier.resource = resource;
    for (uint16_t layer = 0; layer < image.layers; ++layer) {
      barrier.range = {static_cast<uint16_t>(layer % image.mips), 1, layer, 1};
      plan.barriers.push_back(barrier);
    }
  }
  const Verdict verdict = verify(plan);
  EXPECT_THAT(verdict.violations, IsEmpty());
  EXPECT_THAT(verdict.not_verified, HasSubstr("subresources"));
  EXPECT_FALSE(verdict.proven());
}

// Every two accesses of a pass are compared.
TEST(Verify, TooManyAccesses_GivesUp) {
  const auto b = everything();
  Plan plan = compiled(b).plan;
  PlanPass& last = plan.passes.back();
  ASSERT_EQ(last.first_access + last.access_count, plan.accesses.size());
  const auto read = std::find_if(
      plan.accesses.begin() + last.first_access, plan.accesses.end(),
      [](const PlanAccess& access) { return (access.access & all_write_access) == 0; });
  ASSERT_NE(read, plan.accesses.end());
  const PlanAccess again = *read;
  constexpr uint32_t more = 12000;
  plan.accesses.insert(plan.accesses.end(), more, again);
  last.access_count += more;
  const Verdict verdict = verify(plan);
  EXPECT_THAT(verdict.violations, IsEmpty());
  EXPECT_THAT(verdict.not_verified, HasSubstr("would take more than"));
}

TEST(Verify, RejectsAWriteToAnEarlierFrame) {
  const auto redirect = [](Plan& plan) {
    for (PlanAccess& access : plan.accesses)
      if ((access.access & all_write_access) != 0 &&
          plan.resources[access.resource].instance_count > 1)
        access.frames_back = 1;
  };
  expect_rejected(redirect, "is written, although it holds an earlier frame");
}

TEST(Verify, RejectsPlacementsOutsideTheirHeapOrMisaligned) {
  expect_rejected([](Plan& plan) { plan.heaps[0].size = 1; }, "exceeds its heap");
  expect_rejected([](Plan& plan) { plan.placements[0].offset = 1; }, "misaligned");
}

TEST(Verify, RejectsIndicesOutOfRange) {
  expect_rejected([](Plan& plan) { plan.accesses[0].resource = 1000; }, "does not exist");
  expect_rejected([](Plan& plan) { plan.accesses[0].frames_back = 7; }, "does not exist");
  expect_rejected([](Plan& plan) { plan.barriers[0].resource = 1000; }, "does not exist");
  expect_rejected([](Plan& plan) { plan.passes[0].access_count = 1000; }, "do not exist");
  expect_rejected([](Plan& plan) { plan.passes[0].first_barrier = 0xffffffff; }, "do not exist");
  expect_rejected([](Plan& plan) { plan.histories.clear(); }, "not described exactly once");
}

TEST(Verify, RejectsAWrongLayout) {
  expect_rejected([](Plan& plan) { plan.accesses.back().layout = Layout::transfer_source; },
                  "not in the layout that the plan states for the access");
  expect_rejected([](Plan& plan) { plan.history_layouts[1] = Layout::transfer_source; }, "layout");
}

TEST(Verify, RejectsImagesInAnUndefinedLayout) {
  expect_rejected(
      [](Plan& plan) {
        for (PlanAccess& access : plan.accesses)
          if (access.layout == Layout::general) access.layout = Layout::undefined;
      },
      "an image in an undefined layout");
}

TEST(Verify, RejectsMoreHistoryThanAGraphMayHave) {
  constexpr uint32_t frames = 300000;
  expect_rejected(
      [](Plan& plan) {
        PlanHistory& history = plan.histories.at(0);
        PlanResource& resource = plan.resources[history.resource];
        Placement placement = plan.placements[resource.first_instance];
        history.frames = resource.instance_count = frames;
        resource.first_instance = static_cast<uint32_t>(plan.placements.size());
        for (uint32_t i = 0; i < frames; ++i) {
          placement.offset = plan.heaps[placement.heap].size;
          plan.heaps[placement.heap].size += placement.size + placement.alignment;
          plan.heaps[placement.heap].size -= plan.heaps[placement.heap].size % placement.alignment;
          plan.placements.push_back(placement);
        }
        history.first_layout = static_cast<uint32_t>(plan.history_layouts.size());
        plan.history_layouts.resize(history.first_layout +
                                    (size_t{frames} + 1) * history.range_count);
      },
      "a history has the wrong number of instances");
}

TEST(Verify, RejectsHistoriesThatNoDeviceCanKeep) {
  expect_rejected(
      [](Plan& plan) {
        for (uint32_t r = 0; r < plan.resources.size(); ++r)
          if (plan.resources[r].first_instance == no_instance) plan.histories[0].resource = r;
      },
      "a history is in memory of the host");
  expect_rejected(
      [](Plan& plan) {
        for (Heap& heap : plan.heaps)
          heap.persistent = false;
      },
      "a history is in a heap whose contents do not last");
}

// Overlapping ranges of many histories would take hours to simulate.
TEST(Verify, RejectsHistoryRangesThatAreNotTheWholeResource) {
  expect_rejected(
      [](Plan& plan) {
        plan.history_ranges.push_back(plan.history_ranges[0]);
        plan.histories[0].range_count = 2;
        plan.history_layouts.resize(2 * plan.history_layouts.size());
      },
      "the subresource ranges of a history are not its whole resource");
  expect_rejected([](Plan& plan) { plan.histories.push_back(plan.histories[0]); },
                  "not in the order of the histories");
}

TEST(Verify, RejectsHeapsThatNoMemorySuits) {
  expect_rejected([](Plan& plan) { plan.heaps[0].alignment = 1; },
                  "a heap is less aligned than a placement in it");
  expect_rejected([](Plan& plan) { plan.heaps[0].memory_type_bits = 0; },
                  "no memory type suits a heap");
}

TEST(Verify, RejectsStagesAndAccessesThatDoNotExist) {
  constexpr uint64_t unknown = 1ull << 63;
  expect_rejected([](Plan& plan) { plan.accesses[0].stages |= unknown; }, "an access has");
  expect_rejected([](Plan& plan) { plan.accesses[0].access |= unknown; }, "an access has");
  expect_rejected([](Plan& plan) { plan.accesses[0].stages = 0; }, "an access has no stages");
  expect_rejected([](Plan& plan) { plan.barriers[0].source_stages |= unknown; }, "a barrier has");
  expect_rejected([](Plan& plan) { plan.barriers[0].destination_stages |= unknown; },
                  "a barrier has");
  expect_rejected([](Plan& plan) { plan.barriers[0].source_access |= unknown; }, "a barrier has");
  expect_rejected([](Plan& plan) { plan.barriers[0].destination_access |= unknown; },
                  "a barrier has");
}

TEST(Verify, RejectsAnInstanceOutsideItsLifetime) {
  expect_rejected(
      [](Plan& plan) {
        for (Placement& placement : plan.placements)
          if (placement.persistent && &placement != &plan.placements[0] &&
              placement.resource == (&placement - 1)->resource)
            placement.last_use = 0; // of every instance except the first
      },
      "outside its lifetime");
}

TEST(Verify, RejectsAReadOutsideItsLifetime) {
  expect_rejected(
      [](Plan& plan) {
        for (Placement& placement : plan.placements)
          if (!placement.persistent) placement.last_use = placement.first_use;
      },
      "outside its lifetime");
}

// Expects that the verifier refuses every plan in which `weaken` changed one barrier. `weaken`
// returns false for barriers that it leaves unchanged.
void expect_each_rejected(const std::function<bool(PlanBarrier&)>& weaken) {
  for (uint64_t seed = 0; seed < verified_graphs && !::testing::Test::HasFailure(); ++seed) {
    const auto builder = random_graph(seed);
    const auto whole = compiled(builder);
    for (uint32_t i = 0; i < whole.plan.barriers.size(); ++i) {
      Plan mutant = whole.plan;
      if (!weaken(mutant.barriers[i])) continue;
      EXPECT_THAT(verify(mutant).violations, Not(IsEmpty()))
          << "seed " << seed << ", barrier " << i << ": "
          << reasons(builder, whole, Reason::About::barrier, i);
    }
  }
}

TEST(Verify, RejectsBarriersWithoutSourceStages) {
  expect_each_rejected([](PlanBarrier& barrier) {
    if (barrier.from_host || barrier.source_stages == 0) return false;
    barrier.source_stages = stage::host;
    return true;
  });
}

// An alias barrier names the writes of every occupant, including writes that a later occupant made
// available.
TEST(Verify, RejectsBarriersWithoutSourceAccess) {
  expect_each_rejected([](PlanBarrier& barrier) {
    if (barrier.source_access == 0 || barrier.why == PlanBarrier::ReasonKind::alias) return false;
    barrier.source_access = 0;
    return true;
  });
}

TEST(Verify, RejectsBarriersWithoutDestination) {
  expect_each_rejected([](PlanBarrier& barrier) {
    if (barrier.to_host) return false;
    barrier.destination_stages = stage::host;
    return true;
  });
}

// A pass cannot run before the pass that produces its input.
TEST(Verify, RejectsSwappedPasses) {
  const auto b = everything();
  const Plan plan = compiled(b).plan;
  for (size_t p = 0; p + 1 < plan.passes.size() - 1; ++p) {
    Plan mutant = plan;
    std::swap(mutant.passes[p], mutant.passes[p + 1]);
    EXPECT_THAT(verify(mutant).violations, Not(IsEmpty())) << p;
  }
}

TEST(Verify, RejectsAConditionOnAWriteOrOnNoHistory) {
  const auto set_all = [](ReadWhen when, bool writes) {
    return [=](Plan& plan) {
      for (PlanAccess& access : plan.accesses)
        if (((access.access & all_write_access) != 0) == writes && access.frames_back == 0)
          access.when = when;
    };
  };
  for (const bool writes : {false, true})
    for (const ReadWhen when : {ReadWhen::history_valid, ReadWhen::history_invalid})
      expect_rejected(set_all(when, writes),
                      "does not name the history whose validity it depends on");
}

} // namespace
} // namespace dermis::testing
