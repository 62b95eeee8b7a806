// Tests which earlier write must be visible to a write in memory that several resources use. Two
// writes need only availability (Vulkan 1.3, "Location-Ordered"). The verifier and the oracle also
// require visibility of the last write, unless it was read since.

#include "tests/framegraph/graph_builder.hpp"
#include "tests/framegraph/hazard_oracle.hpp"

#include "framegraph/verify/verify.hpp"

#include <gtest/gtest.h>

namespace dermis::testing {
namespace {

uint32_t planned(const GraphBuilder& builder, const Plan& plan, const char* name) {
  for (uint32_t r = 0; r < plan.resources.size(); ++r)
    if (plan.resources[r].declared == builder.resource(name)) return r;
  ADD_FAILURE() << name << " is not in the plan";
  return 0;
}

// Makes no earlier write visible to the first write of `list`; the order of both stays.
void show_nothing_to_list(const GraphBuilder& builder, Plan& plan) {
  const uint32_t list = planned(builder, plan, "list");
  for (PlanBarrier& barrier : plan.barriers)
    if (barrier.why == PlanBarrier::ReasonKind::alias && barrier.resource == list)
      barrier.destination_access = access::none;
}

void expect_accepted(const Plan& plan, bool accepted) {
  EXPECT_EQ(verify(plan).violations.empty(), accepted);
  EXPECT_EQ(first_hazard(plan).empty(), accepted) << first_hazard(plan);
}

// `unread`, `middle` and `list` use the same memory one after the other.
GraphBuilder three_in_the_same_memory(bool middle_is_read) {
  GraphBuilder b;
  b.import("light");
  for (const char* name : {"kept", "unread", "middle"})
    b.image(name);
  b.buffer("list");
  for (const char* name : {"left", "right"})
    b.exported(name);
  b.pass("write unread", "test.shade", {{"a", "light"}}, {{"out", "kept"}, {"out2", "unread"}});
  b.pass("write middle", "test.shade", {{"a", "kept"}}, {{"out", "left"}, {"out2", "middle"}});
  if (middle_is_read) b.pass("read middle", "test.probe", {{"a", "middle"}}, {});
  b.pass("write list", "test.fill", {}, {{"target", "list"}});
  b.pass("read list", "test.tiles", {{"tiles", "list"}, {"arguments", "list"}, {"a", "kept"}},
         {{"out", "right"}});
  return b;
}

TEST(AliasWrite, OverwrittenUnreadWrite_NeedsNoVisibility) {
  for (const bool middle_is_read : {true, false}) {
    const GraphBuilder b = three_in_the_same_memory(middle_is_read);
    Plan plan = compiled(b).plan;
    const auto offset = [&](const char* name) {
      return plan.placements[plan.resources[planned(b, plan, name)].first_instance].offset;
    };
    ASSERT_EQ(offset("unread"), offset("list"));
    ASSERT_EQ(offset("middle"), offset("list"));
    expect_accepted(plan, true);
    show_nothing_to_list(b, plan);
    expect_accepted(plan, middle_is_read);
  }
}

// Moves the last barrier of a pass to the next pass.
void move_barrier(Plan& plan, uint32_t pass) {
  --plan.passes[pass].barrier_count;
  --plan.passes[pass + 1].first_barrier;
  ++plan.passes[pass + 1].barrier_count;
}

// `list` is written after one of two mips of a history has overwritten `unread`. The other mip is
// written later, so `unread` may still be the last write to some bytes of `list`.
TEST(AliasWrite, PartlyOverwrittenWrite_MustBeVisible) {
  GraphBuilder b;
  b.import("light");
  b.history("sum").mips = 2;
  b.image("unread");
  b.buffer("list");
  for (const char* name : {"first", "second", "third"})
    b.exported(name);
  b.pass("read sum", "test.shade", {{"a", "sum#1@-1"}}, {{"out", "first"}});
  b.pass("write unread", "test.shade", {{"a", "first"}}, {{"out", "second"}, {"out2", "unread"}});
  b.pass("write mip 0", "test.shade", {{"a", "second"}}, {{"out", "sum#0"}});
  b.pass("read mip 0", "test.probe", {{"a", "sum#0"}}, {});
  b.pass("write list", "test.fill", {}, {{"target", "list"}});
  b.pass("read list", "test.tiles", {{"tiles", "list"}, {"arguments", "list"}, {"a", "light"}},
         {{"out", "third"}});
  b.pass("write mip 1", "test.shade", {{"a", "light"}}, {{"out", "sum#1"}});
  Plan plan = compiled(b).plan;
  // All three resources use the memory of the history, with barriers that wait for everything.
  const PlanResource& sum = plan.resources[planned(b, plan, "sum")];
  ASSERT_EQ(sum.instance_count, 1u);
  for (Placement& placement : plan.placements) {
    placement.heap = plan.placements[sum.first_instance].heap;
    placement.offset = plan.placements[sum.first_instance].offset;
  }
  for (PlanBarrier& barrier : plan.barriers) {
    const bool host = plan.resources[barrier.resource].first_instance == no_instance;
    if (host || barrier.frames_back != 0) continue;
    barrier.source_stages |= stage::compute_shader | stage::draw_indirect | stage::all_transfer;
    barrier.source_access |= access::shader_storage_write | access::transfer_write;
  }
  move_barrier(plan, 3); // The barrier of `list` waits for the reader of mip 0.
  move_barrier(plan, 5); // The barrier of mip 1 waits for the reader of `list`.
  expect_accepted(plan, true);
  show_nothing_to_list(b, plan);
  expect_accepted(plan, false);
}

} // namespace
} // namespace dermis::testing
