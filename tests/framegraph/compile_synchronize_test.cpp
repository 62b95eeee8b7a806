// Tests that barriers, layouts and histories wait for every hazard and for nothing else.

#include "tests/framegraph/graph_builder.hpp"
#include "tests/framegraph/hazard_oracle.hpp"

#include "framegraph/verify/verify.hpp"

namespace dermis::testing {
namespace {

using ReasonKind = PlanBarrier::ReasonKind;

std::vector<PlanBarrier> barriers_before(const GraphBuilder& b, const Plan& plan,
                                         const std::string& pass) {
  for (const PlanPass& one : plan.passes)
    if (one.declared == b.pass_id(pass))
      return {plan.barriers.begin() + one.first_barrier,
              plan.barriers.begin() + one.first_barrier + one.barrier_count};
  ADD_FAILURE() << pass << " does not run";
  return {};
}

// Returns the only barrier on `resource` before `pass`, or a default barrier with no resource if
// none exists.
PlanBarrier barrier_on(const GraphBuilder& b, const Plan& plan, const std::string& pass,
                       const std::string& resource, uint32_t frames_back = 0) {
  PlanBarrier found;
  found.resource = no_instance;
  for (const PlanBarrier& barrier : barriers_before(b, plan, pass))
    if (plan.resources[barrier.resource].declared == b.resource(resource) &&
        barrier.frames_back == frames_back) {
      EXPECT_EQ(found.resource, no_instance) << "two barriers on " << resource;
      found = barrier;
    }
  return found;
}

TEST(Synchronize, AReadWaitsForTheWriteAndChangesTheLayout) {
  GraphBuilder b{"import light", "image blurred", "export result"};
  b.pass("blur", "test.shade", {{"a", "light"}}, {{"out", "blurred"}});
  b.pass("finish", "test.shade", {{"a", "blurred"}}, {{"out", "result"}});
  const auto whole = compiled(b);
  const auto barrier = barrier_on(b, whole.plan, "finish", "blurred");
  EXPECT_EQ(barrier.why, ReasonKind::read_after_write);
  EXPECT_EQ(barrier.source_stages, stage::compute_shader);
  EXPECT_EQ(barrier.source_access, access::shader_storage_write);
  EXPECT_EQ(barrier.destination_stages, stage::compute_shader);
  EXPECT_EQ(barrier.destination_access, access::shader_sampled_read);
  EXPECT_EQ(barrier.old_layout, Layout::general);
  EXPECT_EQ(barrier.new_layout, Layout::shader_read_only);
}

TEST(Synchronize, ASecondReadInTheSameLayoutNeedsNoBarrier) {
  GraphBuilder b{"import light", "export first", "export second"};
  b.pass("one", "test.need", {{"a", "light"}}, {{"out", "first"}});
  b.pass("two", "test.need", {{"a", "light"}}, {{"out", "second"}});
  const auto whole = compiled(b);
  EXPECT_EQ(barrier_on(b, whole.plan, "one", "light").why, ReasonKind::host_before);
  EXPECT_EQ(barrier_on(b, whole.plan, "two", "light").resource, no_instance);
}

TEST(Synchronize, BufferReadAtTwoStagesGetsOneBarrier) {
  GraphBuilder b{"buffer tiles", "export result"};
  b.pass("list", "test.list", {}, {{"tiles", "tiles"}});
  b.pass("scatter", "test.tiles", {{"tiles", "tiles"}, {"arguments", "tiles"}},
         {{"out", "result"}});
  const auto whole = compiled(b);
  const auto barrier = barrier_on(b, whole.plan, "scatter", "tiles");
  EXPECT_EQ(barrier.destination_stages, stage::compute_shader | stage::draw_indirect);
  EXPECT_EQ(barrier.destination_access,
            access::shader_storage_read | access::indirect_command_read);
  EXPECT_EQ(barrier.old_layout, Layout::undefined);
  EXPECT_EQ(barrier.new_layout, Layout::undefined);
}

TEST(Synchronize, ReadAtAnotherStage_GetsItsOwnBarrier) {
  GraphBuilder b{"buffer tiles", "export first", "export second", "export third"};
  b.pass("list", "test.list", {}, {{"tiles", "tiles"}});
  b.pass("one", "test.tiles", {{"tiles", "tiles"}}, {{"out", "first"}});
  b.pass("two", "test.tiles", {{"arguments", "tiles"}}, {{"out", "second"}});
  b.pass("three", "test.tiles", {{"tiles", "tiles"}, {"arguments", "tiles"}}, {{"out", "third"}});
  const auto whole = compiled(b);
  EXPECT_EQ(barrier_on(b, whole.plan, "two", "tiles").destination_stages, stage::draw_indirect);
  EXPECT_EQ(barrier_on(b, whole.plan, "two", "tiles").source_stages, stage::compute_shader);
  EXPECT_EQ(barrier_on(b, whole.plan, "three", "tiles").resource, no_instance);
}

TEST(Synchronize, ClearedBufferIsMadeAvailableToEachKindOfReader) {
  // No barrier of the first reader ends at the stage of the clear, where the second one's begins.
  GraphBuilder b{"buffer tiles", "export first", "export second"};
  b.pass("clear", "test.fill", {}, {{"target", "tiles"}});
  b.pass("one", "test.tiles", {{"tiles", "tiles"}}, {{"out", "first"}});
  b.pass("two", "test.tiles", {{"arguments", "tiles"}}, {{"out", "second"}});
  const auto whole = compiled(b);
  const auto barrier = barrier_on(b, whole.plan, "two", "tiles");
  EXPECT_EQ(barrier.source_stages, usage_info(Usage::clear).stages);
  EXPECT_EQ(barrier.source_access, usage_info(Usage::clear).access);
}

TEST(Synchronize, UpdateWaitsForReadersAndTheWriteItReads) {
  GraphBuilder b{"buffer tiles", "export first", "export second"};
  b.pass("list", "test.list", {}, {{"tiles", "tiles"}});
  b.pass("one", "test.tiles", {{"arguments", "tiles"}}, {{"out", "first"}});
  b.pass("count", "test.count", {}, {{"tiles", "tiles"}});
  b.pass("two", "test.tiles", {{"tiles", "tiles"}}, {{"out", "second"}});
  const auto whole = compiled(b);
  const auto barrier = barrier_on(b, whole.plan, "count", "tiles");
  EXPECT_EQ(barrier.source_stages, stage::draw_indirect | stage::compute_shader);
}

TEST(Synchronize, WriteAfterReadIsAnExecutionDependency) {
  // The host buffer is read, then overwritten by a pass that does not read it.
  GraphBuilder b;
  auto& tiles = b.buffer("tiles");
  tiles.origin = Origin::imported;
  tiles.exported = true;
  b.exported("first");
  b.pass("one", "test.tiles", {{"arguments", "tiles"}}, {{"out", "first"}});
  b.pass("clear", "test.fill", {}, {{"target", "tiles"}});
  const auto whole = compiled(b);
  const auto barrier = barrier_on(b, whole.plan, "clear", "tiles");
  EXPECT_EQ(barrier.why, ReasonKind::write_after_read);
  EXPECT_EQ(barrier.source_stages, stage::draw_indirect);
  EXPECT_EQ(barrier.source_access, access::none);
  EXPECT_EQ(barrier.destination_stages, usage_info(Usage::clear).stages);
  EXPECT_EQ(barrier.destination_access, access::none);
}

TEST(Synchronize, ReadAndWriteInOnePassUseOneLayout) {
  GraphBuilder b;
  b.import("light").exported = true;
  b.pass("combine", "test.blend", {{"own", "light"}}, {{"out", "light"}});
  const auto whole = compiled(b);
  for (const PlanAccess& access : whole.plan.accesses)
    EXPECT_EQ(access.layout, Layout::general);
  EXPECT_EQ(barrier_on(b, whole.plan, "combine", "light").new_layout, Layout::general);
}

TEST(Synchronize, HostSlotsAreAcquiredAndReleasedOnce) {
  GraphBuilder b{"import light", "import unused", "export result"};
  b.pass("finish", "test.need", {{"a", "light"}}, {{"out", "result"}});
  const auto whole = compiled(b);
  EXPECT_THAT(barriers_before(b, whole.plan, "finish"), SizeIs(2));
  for (const PlanBarrier& barrier : barriers_before(b, whole.plan, "finish"))
    EXPECT_TRUE(barrier.from_host);
  EXPECT_EQ(whole.plan.final_barrier_count, 3u);
  for (uint32_t i = 0; i < whole.plan.final_barrier_count; ++i) {
    const PlanBarrier& barrier = whole.plan.barriers[whole.plan.first_final_barrier + i];
    EXPECT_TRUE(barrier.to_host);
    const bool unused = whole.plan.resources[barrier.resource].declared == b.resource("unused");
    EXPECT_EQ(barrier.from_host, unused);
  }
}

TEST(Aliasing, NewOccupantWaitsForAllOldOnesAndDiscards) {
  GraphBuilder b;
  b.import("light");
  for (const char* name : {"one", "two", "three", "four"})
    b.image(name);
  b.exported("result");
  b.pass("p1", "test.need", {{"a", "light"}}, {{"out", "one"}});
  b.pass("p2", "test.need", {{"a", "one"}}, {{"out", "two"}});
  b.pass("p3", "test.need", {{"a", "two"}}, {{"out", "three"}});
  b.pass("p4", "test.need", {{"a", "three"}}, {{"out", "four"}});
  b.pass("p5", "test.need", {{"a", "four"}}, {{"out", "result"}});
  const auto whole = compiled(b);
  ASSERT_THAT(whole.plan.heaps, SizeIs(1));
  // At most two of the four images are alive at a time.
  EXPECT_EQ(whole.plan.heaps[0].size, 2 * whole.plan.placements[0].size);
  const auto barrier = barrier_on(b, whole.plan, "p3", "three");
  EXPECT_EQ(barrier.why, ReasonKind::alias);
  EXPECT_EQ(barrier.old_layout, Layout::undefined);
  EXPECT_EQ(barrier.source_stages, stage::compute_shader);
  // p2 reads 'one' last. Across the frame boundary both were last read, so no write has to be made
  // available.
  EXPECT_EQ(barrier.source_access, access::none);
  uint32_t index = 0;
  while (whole.plan.barriers[index].why != ReasonKind::alias)
    ++index;
  EXPECT_THAT(reasons(b, whole, Reason::About::barrier, index), HasSubstr("reuses memory of"));
}

TEST(Aliasing, FirstOccupantWaitsForThePreviousFrame) {
  GraphBuilder b{"import light", "buffer tiles", "export result"};
  b.pass("list", "test.list", {}, {{"tiles", "tiles"}});
  b.pass("scatter", "test.tiles", {{"tiles", "tiles"}, {"arguments", "tiles"}},
         {{"out", "result"}});
  const auto whole = compiled(b);
  const auto barrier = barrier_on(b, whole.plan, "list", "tiles");
  EXPECT_EQ(barrier.why, ReasonKind::first_use);
  EXPECT_EQ(barrier.source_stages, stage::compute_shader | stage::draw_indirect);
}

GraphBuilder accumulation(uint32_t frames, const char* read) {
  GraphBuilder b;
  b.import("light");
  b.history("sum", frames);
  b.exported("result");
  b.pass("accumulate", "test.shade", {{"a", "light"}, {"b", read}}, {{"out", "sum"}});
  b.pass("show", "test.need", {{"a", "sum"}}, {{"out", "result"}});
  return b;
}

TEST(History, InstancesRotateAndKeepThreeFrames) {
  const auto b = accumulation(2, "sum@-2");
  const auto whole = compiled(b);
  ASSERT_THAT(whole.plan.histories, SizeIs(1));
  const PlanResource& sum = whole.plan.resources[whole.plan.histories[0].resource];
  EXPECT_EQ(sum.instance_count, 3u);
  EXPECT_EQ(whole.plan.history_bytes, 3 * whole.plan.placements[sum.first_instance].size);
  EXPECT_EQ(whole.plan.transient_bytes, 0u);
  // `sum` is written in `general` and read by 'show' in `shader_read_only`. It keeps that layout
  // one and two frames later.
  EXPECT_THAT(whole.plan.history_layouts,
              ElementsAre(Layout::undefined, Layout::shader_read_only, Layout::shader_read_only));
  for (uint32_t i = 0; i < 3; ++i)
    EXPECT_TRUE(whole.plan.placements[sum.first_instance + i].persistent);
}

TEST(InPlace, WithoutOwnTexelsReadAndWriteAreRejected) {
  GraphBuilder b;
  b.import("light").exported = true;
  b.pass("blur", "test.need", {{"a", "light"}}, {{"out", "light"}});
  rejected_once(b, DiagnosticId::in_place_race, "'blur' reads 'light' through its port 'a'");
}

TEST(InPlace, OtherwiseValueIsCheckedForRaces) {
  GraphBuilder b{"in_out light", "image x"};
  b.boolean("on", true);
  auto& make = b.pass("make", "test.need", {{"a", "light"}}, {{"out", "x"}});
  make.when = b.when("on");
  b.otherwise(make, "x", "light");
  b.pass("blur", "test.need", {{"a", "x"}}, {{"out", "light"}});
  compiled(b);
  auto input = b.input();
  input.settings = {{SettingType::boolean, 0, 0.0}};
  EXPECT_EQ(rejected(b, input)[0].id, DiagnosticId::in_place_race);
}

TEST(InPlace, VerifierRejectsARaceInsideAPass) {
  GraphBuilder b;
  b.import("light").exported = true;
  b.pass("blend", "test.blend", {{"own", "light"}}, {{"out", "light"}});
  Plan plan = compiled(b).plan;
  ASSERT_THAT(plan.accesses, SizeIs(2));
  EXPECT_TRUE(plan.accesses[0].own_texels);
  plan.accesses[0].own_texels = false;
  EXPECT_THAT(verify(plan).violations, Contains(HasSubstr("without own_texels")));
  EXPECT_NE(first_hazard(plan), "");
}

GraphBuilder levels() {
  GraphBuilder b{"import light", "image pyramid", "export result"};
  b.pass("down", "test.levels", {{"a", "light"}}, {{"out", "pyramid"}});
  b.pass("show", "test.need", {{"a", "pyramid"}}, {{"out", "result"}});
  return b;
}

TEST(InternalOrder, IsPlannedAsAWriteThatAlsoReads) {
  const GraphBuilder b = levels();
  const Plan plan = compiled(b).plan;
  const Access update = access::shader_storage_read | access::shader_storage_write;
  size_t ordered = 0, waits = 0;
  for (const PlanAccess& access : plan.accesses) {
    if (!access.internally_ordered) continue;
    EXPECT_EQ(access.access, update);
    ++ordered;
  }
  EXPECT_EQ(ordered, 1u);
  for (const PlanBarrier& barrier : plan.barriers)
    waits += barrier.destination_access == update;
  EXPECT_EQ(waits, 1u);
}

TEST(InternalOrder, VerifierRejectsReadsWithoutDeclaration) {
  Plan plan = compiled(levels()).plan;
  EXPECT_THAT(verify(plan).violations, IsEmpty());
  EXPECT_EQ(first_hazard(plan), "");
  for (PlanAccess& access : plan.accesses)
    access.internally_ordered = false;
  EXPECT_THAT(verify(plan).violations, Contains(HasSubstr("its contents are not defined")));
  EXPECT_NE(first_hazard(plan), "");
}

TEST(InternalOrder, VerifierRejectsDeclarationsOnReads) {
  Plan plan = compiled(levels()).plan;
  for (PlanAccess& access : plan.accesses)
    access.internally_ordered = (access.access & all_write_access) == 0;
  EXPECT_THAT(verify(plan).violations,
              Contains(HasSubstr("an internally ordered access does not write")));
}

TEST(InternalOrder, DoesNotCoverAnotherPort) {
  GraphBuilder b{"in_out light"};
  b.pass("down", "test.levels", {{"a", "light"}}, {{"out", "light"}});
  EXPECT_EQ(rejected(b)[0].id, DiagnosticId::in_place_race);
}

const PlanResource& history_of(const Plan& plan) {
  return plan.resources[plan.histories.at(0).resource];
}

TEST(History, ReadBeforeWritten_IsUpdatedInPlace) {
  GraphBuilder b;
  b.import("light");
  b.history("sum", 2);
  b.exported("result");
  b.pass("show", "test.need", {{"a", "sum@-2"}}, {{"out", "result"}});
  b.pass("accumulate", "test.shade", {{"a", "light"}, {"b", "sum@-1"}}, {{"out", "sum"}});
  const auto whole = compiled(b);
  EXPECT_EQ(whole.plan.histories.at(0).frames, 2u);
  EXPECT_EQ(history_of(whole.plan).instance_count, 2u);
  EXPECT_THAT(reasons(b, whole, Reason::About::resource, b.resource("sum").value),
              HasSubstr("no later pass reads"));
  CompileInput apart = b.input();
  apart.alias = false;
  EXPECT_EQ(history_of(compiled(b, apart).plan).instance_count, 3u);
}

GraphBuilder blend(const char* port) {
  GraphBuilder b{"import light", "history sum", "export result"};
  b.pass("accumulate", "test.blend", {{port, "sum@-1"}}, {{"out", "sum"}});
  b.pass("show", "test.need", {{"a", "sum"}}, {{"out", "result"}});
  return b;
}

TEST(History, ReadWithOwnTexels_IsOverwritten) {
  const auto own = compiled(blend("own")).plan;
  EXPECT_EQ(history_of(own).instance_count, 1u);
  for (const PlanAccess& access : own.accesses)
    if (access.resource == own.histories.at(0).resource && access.frames_back == 1) {
      EXPECT_EQ(access.layout, Layout::general);
      EXPECT_TRUE(access.own_texels);
    }
  EXPECT_EQ(history_of(compiled(blend("a")).plan).instance_count, 2u);
}

TEST(History, ReadByALaterPass_IsNotOverwritten) {
  GraphBuilder b = blend("own");
  b.exported("before");
  b.pass("look back", "test.need", {{"a", "sum@-1"}}, {{"out", "before"}});
  CompileInput input = b.input();
  input.order = PassOrder::program;
  EXPECT_EQ(history_of(compiled(b, input).plan).instance_count, 2u);
}

TEST(History, VerifierRejectsAnEarlyOverwrite) {
  Plan freely = compiled(blend("own")).plan;
  for (PlanAccess& access : freely.accesses)
    access.own_texels = false;
  EXPECT_FALSE(verify(freely).violations.empty());
  Plan flat = compiled(blend("a")).plan;
  flat.resources[flat.histories.at(0).resource].instance_count = 1;
  EXPECT_FALSE(verify(flat).violations.empty());
}

TEST(History, ValidityNeverChangesThePacking) {
  for (const char* port : {"own", "a"}) {
    const GraphBuilder usual = blend(port);
    GraphBuilder other = blend(port);
    HistoryDeclaration& history = other.graph.resources[other.resource("sum").value].history;
    history.first = HistoryDeclaration::First::clear;
    history.on_cut = HistoryDeclaration::OnCut::keep;
    history.on_resize = HistoryDeclaration::OnResize::rescale;
    const Plan one = compiled(usual).plan, two = compiled(other).plan;
    ASSERT_EQ(one.placements.size(), two.placements.size());
    for (size_t i = 0; i < one.placements.size(); ++i)
      EXPECT_EQ(one.placements[i].offset, two.placements[i].offset);
    EXPECT_EQ(one.history_bytes, two.history_bytes);
  }
}

TEST(History, HasOnlyTheInstancesThatThePlanReads) {
  EXPECT_EQ(compiled(accumulation(3, "sum@-1")).plan.histories[0].frames, 1u);
  const auto unread = compiled(accumulation(3, "light"));
  EXPECT_THAT(unread.plan.histories, SizeIs(0));
  EXPECT_EQ(unread.plan.history_bytes, 0u);
  EXPECT_GT(unread.plan.transient_bytes, 0u);
}

TEST(History, ReadWaitsForPreviousFrame_NewestReusesOldest) {
  GraphBuilder b{"import light", "history sum", "export result"};
  b.pass("accumulate", "test.shade", {{"a", "light"}, {"b", "sum@-1"}}, {{"out", "sum"}});
  b.pass("show", "test.need", {{"a", "sum@-1"}}, {{"out", "result"}});
  const auto whole = compiled(b);
  const auto past = barrier_on(b, whole.plan, "accumulate", "sum", 1);
  EXPECT_EQ(past.why, ReasonKind::history);
  EXPECT_EQ(past.source_access, access::shader_storage_write);
  EXPECT_EQ(past.old_layout, Layout::general);
  EXPECT_EQ(past.new_layout, Layout::shader_read_only);
  EXPECT_EQ(whole.plan.history_layouts[1], Layout::general);
  const auto newest = barrier_on(b, whole.plan, "accumulate", "sum", 0);
  EXPECT_EQ(newest.why, ReasonKind::history);
  EXPECT_EQ(newest.old_layout, Layout::undefined);
  // The previous frame read this instance last.
  EXPECT_EQ(newest.source_stages, stage::compute_shader);
  EXPECT_EQ(newest.source_access, access::none);
}

// "old@-1?list" reads `old` of the previous frame, or `list` in frames in which that is not valid.
// Pass `count` then writes `list` again.
GraphBuilder with_conditional_reader() {
  GraphBuilder b{"import light", "buffer list"};
  b.buffer("old").history.frames = 1;
  b.exported("result");
  b.pass("fill", "test.list", {{"a", "light"}}, {{"tiles", "list"}});
  b.pass("keep", "test.list", {{"a", "light"}}, {{"tiles", "old"}});
  b.pass("use", "test.tiles", {{"tiles", "old@-1?list"}}, {{"out", "result"}});
  b.pass("count", "test.count", {}, {{"tiles", "list"}});
  b.exported("late");
  b.pass("again", "test.tiles", {{"tiles", "list"}, {"a", "result"}}, {{"out", "late"}});
  return b;
}

// The test makes the last pass write-only and lets it wait only for the reader, which had waited
// for the earlier write.
TEST(Verify, ConditionalReader_OrdersNoLaterWriter) {
  const auto b = with_conditional_reader();
  Plan plan = compiled(b).plan;
  for (const PlanPass& pass : plan.passes) {
    if (pass.declared != b.pass_id("count")) continue;
    plan.accesses[pass.first_access].access = access::shader_storage_write;
    ASSERT_EQ(pass.barrier_count, 1u);
    plan.barriers[pass.first_barrier].source_access =
        plan.barriers[pass.first_barrier].destination_access = 0;
  }
  EXPECT_FALSE(verify(plan).violations.empty());
  EXPECT_NE(first_hazard(plan), "");
  // If the reader ran in every frame, this barrier would be enough.
  for (PlanAccess& access : plan.accesses)
    access.when = ReadWhen::always;
  EXPECT_TRUE(verify(plan).violations.empty());
  EXPECT_EQ(first_hazard(plan), "");
}

TEST(Synchronize, OtherwiseOfUnwrittenHistory_IsAlwaysRead) {
  auto b = with_conditional_reader();
  b.boolean("keep", false);
  b.graph.passes[1].when = b.when("keep");
  const auto plan = compiled(b);
  for (const PlanAccess& access : plan.plan.accesses)
    EXPECT_EQ(access.when, ReadWhen::always);
  EXPECT_NE(reasons(b, plan, Reason::About::pass, 2).find("reads its 'otherwise' in every frame"),
            std::string::npos);
}

} // namespace
} // namespace dermis::testing
