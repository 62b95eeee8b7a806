#pragma once
// The walk through a frame that finds the barriers: see barriers.cpp. Internal to compile/.

#include "framegraph/compile/barriers.hpp"

namespace dermis {

struct BarrierInput {
  const Graph& graph;
  const Activation& active;
  const Subresources& subresources;
  const Versions& versions;
  const QueueAssignment& queues;
  const ResourceMemory& memory;
  const Histories& histories;
  const Placements& placements;
};

struct BarrierWalk {
  const BarrierInput& in;
  Report& report;
  Plan& plan;
  SyncObjects& objects;
  PassAccesses& accesses;
  BarrierDrafts& drafts;
  QueueSync& queues;
  MemoryOccupancy& memory;
  const std::array<UsageSet, usage_sets>& sets = all_usage_sets();
  uint32_t current = 0; // position
  bool emit = false;    // false: only finds how each object's state ends

  const ResourceSyncInfo& info(uint32_t resource) const { return objects.resources[resource]; }
  Queue queue_at(uint32_t position) const { return plan.passes[position].queue; }
  SubresourceRange range_of(uint32_t resource, uint32_t range) const {
    if (info(resource).ranges == 1) return info(resource).whole;
    return in.subresources.ranges[in.subresources.number(plan.resources[resource].declared, range)];
  }
  void record_reason(uint32_t barrier, Reason::ReasonKind why, uint32_t resource, uint32_t b = 0) {
    report.record_reason(Reason::About::barrier, barrier, why,
                         plan.resources[resource].declared.value, b);
  }

  // ---- barriers.cpp ----

  // Starts a frame: the state of an earlier frame of a history is that of the frame one younger at
  // the end of the previous frame; all other objects have not been accessed.
  void begin_frame();

  // Walks frames without emitting barriers until the states at the end of a frame repeat.
  void find_states_at_frame_end();

  void run_pass(uint32_t position);
  const UsageSet& set_of(const PassAccess& access, UsageSet& copy) const;
  void apply_access(const PassAccess& access, uint32_t position);

  // Places the barrier, or defers it if the image is divided.
  void place(uint32_t draft, uint32_t predecessor, uint32_t position) {
    if (info(drafts.barriers[draft].resource).ranges > 1)
      drafts.deferred.push_back({draft, predecessor});
    else
      drafts.place(draft, predecessor, position);
  }

  // Fills in the barrier that an access needs after the accesses in `state`.
  void fill_dependency(const ObjectState& state, const UsageSet& set, Layout layout,
                       bool needs_visibility, PlanBarrier& barrier) const;

  // Transfers the object with its contents from one queue to the other.
  void transfer_ownership(const PassAccess& access, const ObjectState& state, const UsageSet& set,
                          uint32_t position);

  // Every slot is passed back in the state that the host requested, also a slot that no pass
  // accesses.
  void pass_to_host(uint32_t resource);
  void describe_histories();

  // ---- barrier_accesses.cpp ----

  // Merges the accesses of one pass to each object.
  void gather_accesses(std::span<const Use> uses);

  // A port sees all its ranges in one layout: `general` if they would have several.
  void unify_layouts(std::span<const Use> uses);

  // Lists the accesses of the pass in the plan.
  void add_accesses(PlanPass& pass, std::span<const Use> uses);

  // ---- barrier_memory.cpp ----

  // Locates each resource in the memory of a heap, or in the idle memory of a history.
  void locate_resources();

  // The first barrier of an object whose old contents do not count.
  void begin_lifetime(const PassAccess& access, const UsageSet& set, uint32_t position);

  // The resource becomes the occupant of its bytes; the barrier waits for the occupants before it
  // in this frame. Unoccupied bytes wait for the last occupants of the previous frame: see
  // resolve_aliasing_barriers. Older occupants need no wait, because the last occupant has waited
  // for them. Returns the last pass of this frame that accessed the bytes, or invalid_index.
  uint32_t acquire_memory(uint32_t resource, uint32_t barrier);

  // Returns the position after the last pass that accessed the occupant.
  uint32_t wait_for_occupant(const HeapRange& occupant, uint32_t resource, uint32_t barrier,
                             bool frame_before);
  uint32_t wait_for_ranges(const ResourceSyncInfo& occupant, const ObjectState* first,
                           uint32_t barrier, bool frame_before);
  void wait_for_state(const ObjectState& state, uint32_t barrier, bool frame_before);

  // Completes the first barriers with the occupants of the previous frame, whose last accesses are
  // known when the walk is over. A resource always waits for its own last use in the previous
  // frame, so that a plan whose placements are moved apart stays correct.
  void resolve_aliasing_barriers();
  void resolve_divided_first_uses();
};

inline void add_scope(PlanBarrier& barrier, const SyncScope& scope) {
  barrier.source_stages |= scope.stages;
  barrier.source_access |= scope.access;
}

} // namespace dermis
