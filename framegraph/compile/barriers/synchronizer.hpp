#pragma once
// The walk through a frame that finds what must wait for what: see synchronize.cpp. Internal to compile/.

#include "framegraph/compile/barriers/steps.hpp"

#include <utility>

namespace dermis {

struct Scope {
  Stage stages = 0;
  Access access = 0;
};

// Where a dependency on everything done so far starts.
inline Scope tail(const ObjectState& state) { // nothing, for one that was not touched
  const bool readers_alone = (int{state.readers != 0} & int{state.source_access == 0}) != 0;
  return {state.readers | (readers_alone ? 0 : state.source_stages), state.source_access};
}

struct Synchronizer {
  CompileContext& c;
  Plan& plan;
  const std::array<UsageSet, usage_sets>& sets;
  const bool beside = !c.queue.empty(); // there is an async queue
  std::vector<std::pair<uint32_t, uint32_t>> waiting_parts =
      {};                         // barriers for parts, and what they stand behind
  uint32_t current = 0;           // position
  uint32_t touches_before = 1;    // of the passes walked through so far: see CompileContext::touch_number
  uint32_t touch_count = 0;       // of the pass in hand, first in CompileContext::touches
  bool emit = false;              // barriers; otherwise only how each object ends
  uint32_t last_batch = no_value; // position of the pass behind it

  void record_reason(uint32_t barrier, Reason::ReasonKind why, uint32_t resource, uint32_t b = 0) {
    c.record_reason(Reason::About::barrier, barrier, why, plan.resources[resource].declared.value, b);
  }
  const ResourceSyncInfo& info(uint32_t resource) const { return c.sync_info[resource]; }
  uint32_t roles(uint32_t resource) const { return info(resource).roles; }
  uint32_t parts(uint32_t resource) const { return info(resource).parts; }
  // This frame's and the oldest are one object where the one is written over the other.
  static uint32_t object_of(const ResourceSyncInfo& of, uint32_t frames_back, uint32_t part = 0) {
    return of.first_object + (frames_back == 0 ? of.own_role : frames_back) * of.parts + part;
  }
  SubresourceRange range_of(const ResourceSyncInfo& of, uint32_t resource, uint32_t part) const {
    if (of.parts == 1) return of.whole;
    return c.parts[c.part_number(plan.resources[resource].declared, part)];
  }

  // Returns whether the plan has histories.
  bool number_objects();

  // Earlier frames of a history start where the frame before left them, one role younger; everything else
  // arrives with its first barrier.
  void carry_over();

  // The oldest instance of a history was one role younger when the frame before ended, and so on.
  void find_ends();

  bool two_queues() const { return beside; }
  Queue queue_at(uint32_t position) const { return plan.passes[position].queue; }

  // The pass at `position` comes after the one at `earlier`, of the other queue.
  void need(uint32_t position, uint32_t earlier) {
    c.needs_point[position] = std::max(c.needs_point[position], earlier + 2);
  }
  // Likewise, after one of the frame before.
  void need_frame_before(uint32_t position, uint32_t earlier) {
    c.needs_frame_before[position] = std::max(c.needs_frame_before[position], earlier + 2);
  }

  // The object leaves one queue for the other, with its contents.
  void transfer(const PassTouch& touch, const ObjectState& state, const UsageSet& set, uint32_t position);

  // What the pass does to each object; by use: which of them it touches.
  void collect(uint32_t first_use, uint32_t end);

  // A port sees all its parts in one layout: `general` where they would have several.
  void unify_layouts(uint32_t first_use, uint32_t end);

  bool writes_too(const Use& read, uint32_t first_use, uint32_t end) const;
  void add_accesses(PlanPass& pass, uint32_t first_use, uint32_t end);

  // Adds a barrier for the pass at `position` that waits for nothing of this frame behind the pass at
  // `after`.
  void batch(uint32_t index, uint32_t after, uint32_t position) {
    if (two_queues()) { // the passes between may be the other queue's
      c.batch_of[index] = position;
      return;
    }
    const bool free = (int{after == no_value} | int{after < last_batch}) != 0;
    last_batch = pick((int{last_batch != no_value} & int{free}) != 0, last_batch, position);
    c.batch_of[index] = last_batch;
  }

  uint32_t draft() {
    const auto index = static_cast<uint32_t>(c.batch_of.size());
    c.drafts.emplace_back();
    c.batch_of.push_back(no_value);
    return index;
  }

  // Brings the drafts into the order of their batches, those of one batch as they were found.
  void sort_into_batches();

  void run_pass(uint32_t position);

  // Barriers for parts of one image stand in one batch, so that they can become one barrier.
  void batch_parts(uint32_t position);

  void place(uint32_t index, uint32_t after, uint32_t position) {
    if (c.graph->parts && parts(c.drafts[index].resource) > 1)
      waiting_parts.emplace_back(index, after);
    else
      batch(index, after, position);
  }

  void run_touch(const PassTouch& touch, uint32_t position);

  // Fills in the barrier that an access needs behind `state`.
  void dependency(const ObjectState& state, const UsageSet& set, Layout layout, bool must_see,
                  PlanBarrier& barrier) const;

  void wait_for(PlanBarrier& barrier, const Scope& scope) const {
    barrier.source_stages |= scope.stages;
    barrier.source_access |= scope.access;
  }

  // The first barrier of an object whose old contents do not count.
  void arrive(const PassTouch& touch, const UsageSet& set, Layout layout, uint32_t position);

  // Memory passes from those that had its bytes before in this frame; where there is none, from those that
  // had them last in the frame before, which are known when the walk is over. Earlier ones than the last had
  // to be done before it: the wait reaches them through it.
  // Returns the last pass of this frame that had any of them, no_value if none had.
  uint32_t take_over(uint32_t resource, uint32_t barrier);

  // The first segment that ends behind `at`.
  static size_t behind(const std::vector<Segment>& segments, uint64_t at);

  void inherit(const ObjectState& state, uint32_t barrier, bool frame_before);

  // Barriers that change no layout, and whose work the waits for points do: all that they wait for ran on the
  // other queue, or that queue has waited for it and this one for that.
  void drop_needless();

  // Where there are two queues: the barrier waits for a pass of its own one.
  void wait_here(uint32_t barrier, const Moment& behind);

  // Behind the wait for a point, which ends where the barrier begins.
  void wait_elsewhere(PlanBarrier& barrier, uint32_t position, uint32_t earlier, bool frame_before);

  // What `inherit` does of an object with parts, or where there are two queues.
  uint32_t inherit_parts(const ResourceSyncInfo& of, const ObjectState* state, uint32_t barrier,
                         bool frame_before);

  // Returns the position behind the last pass that touched it.
  uint32_t inherit(const Segment& from, uint32_t resource, uint32_t barrier, bool frame_before);

  // Where each resource arrives. What a history lends is memory of its own, twice: before it is written, and
  // after the last read of its oldest frame. The instance of the latter is that of the former in the next
  // frame.
  void find_memory();

  // The memory that histories lend: the oldest frame has it first.
  void alias_into_history();

  // A resource's own last use in the frame before counts wherever the others lie: a plan whose placements are
  // moved apart stays in order.
  void settle_arrivals();

  // Each part waits for those that had the memory before, and for its own last use in the frame before.
  void settle_parts();

  // Every slot is handed back in the state the host asked for, also one that no pass touched.
  void hand_back(uint32_t resource);

  void describe_histories();
};

} // namespace dermis
