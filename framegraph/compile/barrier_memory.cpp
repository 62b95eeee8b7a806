// First uses: which previous occupants of the memory a resource waits for, in this frame and in the
// frame before.

#include "framegraph/compile/barrier_walk.hpp"
#include "framegraph/compile/hardware.hpp"

#include <algorithm>
#include <span>

namespace dermis {
namespace {

// Returns the first range that ends after `at`. Binary search without branches, then counting: the
// profile of `dermis bench compile` shows mispredicted branches here otherwise.
size_t first_ending_after(const std::vector<HeapRange>& ranges, uint64_t at) {
  constexpr size_t few = 16;
  size_t first = 0, left = ranges.size();
  while (left > few) {
    const size_t half = left / 2;
    first += select(ranges[first + half].end <= at, half, size_t{0});
    left -= half;
  }
  size_t count = 0;
  for (size_t i = first; i < first + left; ++i)
    count += static_cast<size_t>(ranges[i].end <= at);
  return first + count;
}

// Replaces the ranges [first, last) by the bytes of `occupant`. Splits the first and the last
// range; empty leftovers are overwritten.
void replace(std::vector<HeapRange>& ranges, size_t first, size_t last, const HeapRange& occupant) {
  HeapRange left = ranges[first], right = ranges[last - 1];
  const auto has_left = static_cast<size_t>(left.begin < occupant.begin);
  const auto has_right = static_cast<size_t>(right.end > occupant.end);
  left.end = occupant.begin;
  right.begin = occupant.end;
  const size_t pieces = 1 + has_left + has_right, replaced = last - first;
  const auto end = ranges.begin() + static_cast<std::ptrdiff_t>(last);
  if (replaced > pieces)
    ranges.erase(end - static_cast<std::ptrdiff_t>(replaced - pieces), end);
  else if (replaced < pieces)
    ranges.insert(end, pieces - replaced, {});
  ranges[first] = left;
  ranges[first + has_left + has_right] = right;
  ranges[first + has_left] = occupant;
}

} // namespace

void BarrierWalk::locate_resources() {
  const size_t resources = plan.resources.size();
  const std::vector<HistoryAlias>& aliases = in.placements.history_aliases;
  memory.first_uses.clear();
  memory.divided_first_uses.clear();
  memory.first_barrier.assign(resources, invalid_index);
  memory.predecessor.assign(in.subresources.any() ? resources : 0, invalid_index);
  memory.ranges.resize(std::max(memory.ranges.size(), plan.heaps.size()));
  for (uint32_t heap = 0; heap < plan.heaps.size(); ++heap)
    memory.ranges[heap].assign(1, {0, plan.heaps[heap].size, invalid_index, 0});
  // The idle memory of histories: at the start of a frame the oldest frame occupies the second
  // list.
  auto next = static_cast<uint32_t>(plan.heaps.size());
  memory.idle_memory.assign(resources, invalid_index);
  for (const HistoryAlias& alias : aliases) {
    if (alias.target == invalid_index || memory.idle_memory[alias.target] != invalid_index)
      continue;
    memory.idle_memory[alias.target] = next;
    next += 2;
    memory.ranges.resize(std::max<size_t>(memory.ranges.size(), next));
    const uint64_t size = plan.placements[plan.resources[alias.target].first_instance].size;
    memory.ranges[next - 2].assign(1, {0, size, invalid_index, 0});
    memory.ranges[next - 1].assign(1, {0, size, alias.target, info(alias.target).frames - 1});
  }
  memory.location.resize(resources);
  for (uint32_t r = 0; r < resources; ++r) {
    if (info(r).host_owned) continue;
    const Placement& placement = plan.placements[plan.resources[r].first_instance];
    const HistoryAlias& alias = aliases[r];
    MemoryLocation& location = memory.location[r];
    location = {placement.heap, placement.offset, 0};
    if (alias.target != invalid_index)
      location = {memory.idle_memory[alias.target] + (alias.after_last_read ? 1 : 0), alias.offset,
                  0};
    else if (memory.idle_memory[r] != invalid_index)
      location = {memory.idle_memory[r], 0, 0};
    location.end = location.begin + placement.size;
  }
}

inline uint32_t BarrierWalk::wait_for_occupant(const HeapRange& occupant, uint32_t resource,
                                               uint32_t barrier, bool frame_before) {
  const ResourceSyncInfo& of = info(occupant.resource);
  const ObjectState* state =
      objects.states.data() + of.first_object + occupant.frames_back * of.ranges;
  PlanBarrier& draft = drafts.barriers[barrier];
  uint32_t end_of_last = 0;
  if (of.ranges == 1 && !queues.two_queues) { // the common case in the hottest loop of the phase
    add_scope(draft, scope_of(*state));
    end_of_last = state->accessed ? state->last_pass + 1 : 0;
  } else {
    end_of_last = wait_for_ranges(of, state, barrier, frame_before);
  }
  const bool own = occupant.resource == resource;
  if (!own && info(resource).frames == 1) draft.why = PlanBarrier::ReasonKind::alias;
  record_reason(barrier,
                own ? Reason::ReasonKind::after_last_use : Reason::ReasonKind::acquires_memory,
                occupant.resource, frame_before ? 1 : 0);
  return end_of_last;
}

uint32_t BarrierWalk::wait_for_ranges(const ResourceSyncInfo& occupant, const ObjectState* first,
                                      uint32_t barrier, bool frame_before) {
  uint32_t end_of_last = 0;
  for (const ObjectState& state : std::span(first, occupant.ranges)) {
    wait_for_state(state, barrier, frame_before);
    if (state.accessed) end_of_last = std::max(end_of_last, state.last_pass + 1);
  }
  return end_of_last;
}

uint32_t BarrierWalk::acquire_memory(uint32_t resource, uint32_t barrier) {
  const MemoryLocation& own = memory.location[resource];
  std::vector<HeapRange>& ranges = memory.ranges[own.memory];
  if (info(resource).frames == 1) { // begin_lifetime records the reason of histories
    record_reason(barrier, Reason::ReasonKind::first_use, resource);
    memory.first_barrier[resource] = barrier;
  }
  const size_t first = first_ending_after(ranges, own.begin);
  size_t last = first;
  uint32_t end_of_predecessor = 0; // position + 1
  for (; last < ranges.size() && ranges[last].begin < own.end; ++last) {
    const HeapRange& before = ranges[last];
    if (before.resource == invalid_index)
      memory.first_uses.push_back({std::max(own.begin, before.begin), std::min(own.end, before.end),
                                   own.memory, barrier, resource});
    else
      end_of_predecessor =
          std::max(end_of_predecessor, wait_for_occupant(before, resource, barrier, false));
  }
  replace(ranges, first, last, {own.begin, own.end, resource, 0});
  return end_of_predecessor - 1; // invalid_index if there was none
}

void BarrierWalk::begin_lifetime(const PassAccess& access, const UsageSet& set, uint32_t position) {
  const uint32_t draft = drafts.add(), resource = access.resource;
  const ResourceSyncInfo& of = info(resource);
  PlanBarrier& barrier = drafts.barriers[draft];
  uint32_t predecessor = invalid_index;
  barrier.resource = resource;
  barrier.frames_back = access.frames_back;
  barrier.range = range_of(resource, access.range);
  barrier.destination_stages = set.stages;
  barrier.destination_access = set.access;
  barrier.new_layout = access.layout;
  if (of.host_owned) {
    barrier.from_host = true;
    barrier.why = PlanBarrier::ReasonKind::host_before;
    record_reason(draft, Reason::ReasonKind::from_host, resource);
  } else if (of.frames > 1) { // a history: its oldest instance becomes this frame's
    const uint32_t oldest = of.oldest_object(access.range);
    const bool in_place = plan.resources[resource].instance_count < of.frames;
    const ObjectState& before =
        in_place ? objects.states[oldest] : objects.states_at_frame_end[oldest];
    if (in_place && !before.carried) predecessor = before.last_pass;
    if (memory.idle_memory[resource] != invalid_index)
      predecessor = acquire_memory(resource, draft);
    add_scope(barrier, scope_of(before));
    if (queues.two_queues && before.accessed) {
      QueueSyncPoint last =
          (in_place ? queues.last_access : queues.last_access_at_frame_end)[oldest].any;
      if (!in_place) ++last.frames_back;
      queues.wait_on_own_queue(draft, last);
      queues.draft_wait(draft).layout_kept = in_place && before.layout == access.layout;
    }
    barrier.why = PlanBarrier::ReasonKind::history;
    record_reason(draft, Reason::ReasonKind::oldest_instance, resource);
  } else if (of.ranges > 1 && memory.first_barrier[resource] != invalid_index) {
    predecessor = memory.predecessor[resource]; // another range has acquired the memory
    memory.divided_first_uses.push_back({draft, resource, access.object});
    record_reason(draft, Reason::ReasonKind::first_use, resource);
  } else {
    predecessor = acquire_memory(resource, draft);
    if (of.ranges > 1) {
      memory.predecessor[resource] = predecessor;
      memory.divided_first_uses.push_back({draft, resource, access.object});
    }
  }
  place(draft, predecessor, position);
}

void BarrierWalk::wait_for_state(const ObjectState& state, uint32_t barrier, bool frame_before) {
  PlanBarrier& draft = drafts.barriers[barrier];
  if (!queues.two_queues || !state.accessed) return add_scope(draft, scope_of(state));
  const uint32_t position =
      drafts.batch_of[barrier] == invalid_index ? current : drafts.batch_of[barrier];
  if (state.queue == queue_at(position)) {
    add_scope(draft, scope_of(state));
    return queues.wait_on_own_queue(barrier, {frame_before ? 1u : 0u, state.last_pass + 1});
  }
  draft.source_stages |= draft.destination_stages; // the stages that wait for the point
  if (frame_before)
    queues.wait_for_frame_before(position, state.last_pass);
  else
    queues.wait_for_pass(position, state.last_pass);
}

void BarrierWalk::resolve_aliasing_barriers() {
  for (uint32_t r = 0; r < memory.first_barrier.size(); ++r)
    if (memory.first_barrier[r] != invalid_index && info(r).ranges == 1)
      wait_for_occupant({0, 0, r, 0}, r, memory.first_barrier[r], true);
  for (const FirstUse& use : memory.first_uses) {
    // In the previous frame, idle memory of a history was that of the next instance.
    const bool idle = use.memory >= plan.heaps.size();
    const std::vector<HeapRange>& ranges = memory.ranges[use.memory + (idle ? 1 : 0)];
    for (size_t i = first_ending_after(ranges, use.begin);
         i < ranges.size() && ranges[i].begin < use.end; ++i)
      if (ranges[i].resource != use.resource && ranges[i].resource != invalid_index)
        wait_for_occupant(ranges[i], use.resource, use.barrier, true);
  }
  resolve_divided_first_uses();
}

// Each range waits for the previous occupants of the resource's memory, and for its own last use in
// the previous frame. The barrier that acquired the memory is resolved last, because the others
// copy from it.
void BarrierWalk::resolve_divided_first_uses() {
  for (size_t i = memory.divided_first_uses.size(); i-- > 0;) {
    const DividedFirstUse& use = memory.divided_first_uses[i];
    const uint32_t first = memory.first_barrier[use.resource];
    if (use.barrier != first) {
      PlanBarrier& barrier = drafts.barriers[use.barrier];
      const PlanBarrier& acquiring = drafts.barriers[first];
      add_scope(barrier, {acquiring.source_stages, acquiring.source_access});
      if (queues.two_queues) {
        const OwnQueueWait wait = queues.draft_wait(first);
        queues.draft_wait(use.barrier) = wait;
      }
      barrier.why = acquiring.why;
    }
    wait_for_state(objects.states[use.object], use.barrier, true);
    record_reason(use.barrier, Reason::ReasonKind::after_last_use, use.resource, 1);
  }
}

} // namespace dermis
