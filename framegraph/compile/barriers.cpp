// Computes which pass must wait for which earlier access. Read this file first; barrier_walk.hpp
// lists the steps in other files.
//
// The phase walks through the frame once, pass by pass. For each object (one subresource range of
// one frame of a resource) it keeps the state after the last access. Each access of a pass is one
// of these cases:
//
//   the contents are visible, in the right layout     no barrier
//   the first access in this frame                    begin_lifetime: the memory's previous
//                                                     occupant, the host, or the same history in
//                                                     the previous frame
//   the last access was on the other queue            transfer_ownership: release, wait, acquire
//   otherwise                                         one barrier from the last access to this one
//
// Objects of histories start as the previous frame left them, so their states are computed first,
// by walking without emitting barriers. The occupants that a frame's first uses wait for in the
// frame before are known only at the end: resolve_aliasing_barriers.
//
// Barriers share batches: a barrier may be recorded at any boundary between the pass that it waits
// for and its own pass, and as few boundaries as possible get a batch. That is interval stabbing:
// in the order of their ends, each interval takes the last chosen point if it contains that point,
// else its own end becomes a point.

#include "framegraph/compile/barriers.hpp"
#include "framegraph/compile/barrier_walk.hpp"

#include <algorithm>

namespace dermis {

void SyncObjects::number(const Subresources& subresources, const Histories& histories,
                         const Plan& plan) {
  uint32_t count = 0;
  any_history = false;
  resources.resize(plan.resources.size());
  for (uint32_t r = 0; r < plan.resources.size(); ++r) {
    const PlanResource& resource = plan.resources[r];
    const HistoryLifetime& history = histories.by_resource[r];
    ResourceSyncInfo& info = resources[r];
    info.first_object = count;
    info.frames = history.frames + 1;
    info.ranges = subresources.count(resource.declared);
    info.own_frame = history.oldest_updated ? history.frames : 0;
    info.host_owned = resource.first_instance == no_instance;
    info.image = resource.type == ResourceType::image;
    info.whole = resource.whole();
    count += info.objects();
    any_history |= history.frames > 0;
  }
  states.assign(count, {});
}

inline void BarrierWalk::fill_dependency(const ObjectState& state, const UsageSet& set,
                                         Layout layout, bool needs_visibility,
                                         PlanBarrier& barrier) const {
  const bool pending_write = state.source_access != 0;
  const SyncScope everything = scope_of(state);
  barrier.source_stages = everything.stages;
  barrier.source_access = everything.access;
  barrier.destination_stages = set.stages;
  barrier.destination_access = set.access;
  barrier.old_layout = state.layout;
  barrier.new_layout = layout;
  if (layout != state.layout) {
    barrier.why = !pending_write ? PlanBarrier::ReasonKind::layout
                  : set.reads    ? PlanBarrier::ReasonKind::read_after_write
                                 : PlanBarrier::ReasonKind::write_after_write;
  } else if (needs_visibility) {
    barrier.why = PlanBarrier::ReasonKind::read_after_write;
    barrier.source_stages =
        set.writes ? everything.stages | state.source_stages : state.source_stages;
    // If an earlier barrier made the write available to other stages, this one does not follow it.
    if (!pending_write && (state.readers & barrier.source_stages) == 0)
      barrier.source_access = state.written;
  } else {
    barrier.why = pending_write ? PlanBarrier::ReasonKind::write_after_write
                                : PlanBarrier::ReasonKind::write_after_read;
    // The readers only have to be complete: nothing has to be made visible.
    if (!pending_write && state.always_read) barrier.destination_access = 0;
  }
}

// Returns the set of the access's usages. Of an internally ordered access it contains the read of
// what the pass wrote, although it needs nothing earlier to be visible; `copy` holds it.
inline const UsageSet& BarrierWalk::set_of(const PassAccess& access, UsageSet& copy) const {
  const UsageSet& set = sets[access.usages];
  if (!access.internally_ordered) return set;
  copy = set;
  copy.access |= access::shader_storage_read;
  return copy;
}

inline void BarrierWalk::apply_access(const PassAccess& access, uint32_t position) {
  ObjectState& state = objects.states[access.object];
  UsageSet ordered;
  const UsageSet& set = set_of(access, ordered);
  const Layout layout = access.layout;
  bool waited = true;
  const bool other_queue = state.accessed && state.queue != queue_at(position);
  if (!state.accessed) {
    if (emit) begin_lifetime(access, set, position);
  } else if (other_queue) {
    if (emit) transfer_ownership(access, state, set, position);
  } else {
    const bool needs_visibility = set.reads && (access.usages & ~sets[state.visible].covers) != 0;
    waited = layout != state.layout || needs_visibility || set.writes;
    if (waited && emit) {
      const uint32_t draft = drafts.add();
      PlanBarrier& barrier = drafts.barriers[draft];
      barrier.resource = access.resource;
      barrier.frames_back = access.frames_back;
      barrier.range = range_of(access.resource, access.range);
      fill_dependency(state, set, layout, needs_visibility, barrier);
      report.record_reason(Reason::About::barrier, draft, Reason::ReasonKind::dependency,
                           state.last_pass, state.carried ? 1 : 0, position);
      // A barrier that only makes a write visible waits for no reader since then.
      if (queues.two_queues) {
        const bool only_visible = barrier.why == PlanBarrier::ReasonKind::read_after_write &&
                                  !set.writes && layout == state.layout;
        const LastAccess& last = queues.last_access[access.object];
        queues.wait_on_own_queue(draft, only_visible ? last.write : last.any);
      }
      if (state.carried) barrier.why = PlanBarrier::ReasonKind::history;
      place(draft, state.carried ? invalid_index : state.last_pass, position);
    }
  }
  const bool transition = !state.accessed || other_queue || layout != state.layout;
  if (queues.two_queues) {
    LastAccess& last = queues.last_access[access.object];
    last.any = {0, position + 1};
    if (set.writes || transition) last.write = last.any;
  }
  if (set.writes || transition) {
    state.source_stages = set.stages;
    state.source_access = state.written = set.access & all_write_access;
    state.readers = 0;
    state.visible = 0;
    state.always_read = false;
  }
  if (!set.writes) {
    if (waited) {
      state.source_access = 0;
      state.visible = static_cast<uint16_t>(state.visible | access.usages);
    }
    state.readers |= set.stages;
    state.always_read |= access.always;
  }
  state.accessed = true;
  state.carried = false;
  state.queue = queue_at(position);
  state.layout = layout;
  state.last_pass = position;
}

void BarrierWalk::run_pass(uint32_t position) {
  PlanPass& pass = plan.passes[position];
  const std::span<const Use> uses = in.versions.uses_of(pass.declared);
  gather_accesses(uses);
  current = position;
  if (emit) add_accesses(pass, uses);
  drafts.deferred.clear();
  for (uint32_t i = 0; i < accesses.count; ++i)
    apply_access(accesses.list[i], position);
  if (!drafts.deferred.empty()) drafts.place_deferred(position);
}

void BarrierWalk::begin_frame() {
  for (const ResourceSyncInfo& resource : objects.resources) {
    for (uint32_t i = resource.objects(); i-- > 0;) {
      const uint32_t back = i / resource.ranges, range = i % resource.ranges;
      const uint32_t object = resource.first_object + i;
      const uint32_t newer = back == 0 ? 0 : resource.object(back - 1, range);
      objects.states[object] = back == 0 ? ObjectState{} : objects.states_at_frame_end[newer];
      objects.states[object].carried = back != 0;
      if (!queues.two_queues) continue;
      LastAccess& last = queues.last_access[object];
      last = back == 0 ? LastAccess{} : queues.last_access_at_frame_end[newer];
      ++last.any.frames_back;
      ++last.write.frames_back;
    }
  }
}

void BarrierWalk::find_states_at_frame_end() {
  objects.states_at_frame_end.assign(objects.states.size(), {});
  queues.last_access_at_frame_end = queues.last_access;
  uint32_t frames = 1;
  for (const ResourceSyncInfo& resource : objects.resources)
    frames = std::max(frames, resource.frames);
  for (uint32_t frame = 0; frame < frames; ++frame) {
    begin_frame();
    for (uint32_t position = 0; position < plan.passes.size(); ++position)
      run_pass(position);
    objects.states_at_frame_end = objects.states;
    queues.last_access_at_frame_end = queues.last_access;
  }
  begin_frame();
}

void BarrierWalk::transfer_ownership(const PassAccess& access, const ObjectState& state,
                                     const UsageSet& set, uint32_t position) {
  PlanBarrier release;
  release.resource = access.resource;
  release.frames_back = access.frames_back;
  release.range = range_of(access.resource, access.range);
  release.old_layout = state.layout;
  release.new_layout = access.layout;
  release.why = set.reads ? PlanBarrier::ReasonKind::read_after_write
                          : PlanBarrier::ReasonKind::write_after_write;
  PlanBarrier acquire = release;
  const SyncScope scope = scope_of(state);
  release.source_stages = scope.stages;
  release.source_access = scope.access;
  release.transfer = PlanBarrier::Transfer::release;
  acquire.source_stages = acquire.destination_stages =
      set.stages; // the stages that wait for the point
  acquire.destination_access = set.access;
  acquire.transfer = PlanBarrier::Transfer::acquire;
  for (const PlanBarrier& half : {release, acquire}) {
    const uint32_t draft = drafts.add();
    drafts.barriers[draft] = half;
    drafts.batch_of[draft] =
        half.transfer == PlanBarrier::Transfer::release ? state.last_pass : position;
    report.record_reason(Reason::About::barrier, draft, Reason::ReasonKind::dependency,
                         state.last_pass, 0, position);
  }
  queues.wait_for_pass(position, state.last_pass);
}

void BarrierWalk::pass_to_host(uint32_t resource) {
  const ObjectState& end = objects.states[info(resource).first_object];
  const SyncScope scope = scope_of(end);
  PlanBarrier barrier;
  barrier.resource = resource;
  barrier.range = plan.resources[resource].whole();
  barrier.from_host = !end.accessed;
  barrier.to_host = true;
  barrier.source_stages = scope.stages;
  barrier.source_access = scope.access;
  barrier.old_layout = end.layout;
  barrier.why = PlanBarrier::ReasonKind::host_after;
  record_reason(static_cast<uint32_t>(plan.barriers.size()), Reason::ReasonKind::to_host, resource,
                end.accessed ? 0 : 1);
  plan.barriers.push_back(barrier);
}

void BarrierWalk::describe_histories() {
  for (uint32_t r = 0; r < plan.resources.size(); ++r) {
    const ResourceSyncInfo& resource = info(r);
    if (resource.frames == 1) continue;
    PlanHistory history;
    history.resource = r;
    history.frames = resource.frames - 1;
    history.first_layout = static_cast<uint32_t>(plan.history_layouts.size());
    history.declaration = in.graph.resources[plan.resources[r].declared.value].history;
    history.first_range = static_cast<uint32_t>(plan.history_ranges.size());
    history.range_count = resource.ranges;
    for (uint32_t range = 0; range < resource.ranges; ++range)
      plan.history_ranges.push_back(range_of(r, range));
    plan.history_layouts.insert(plan.history_layouts.end(), resource.ranges, Layout::undefined);
    for (uint32_t back = 1; back < resource.frames; ++back)
      for (uint32_t range = 0; range < resource.ranges; ++range)
        plan.history_layouts.push_back(
            objects.states_at_frame_end[resource.object(back - 1, range)].layout);
    plan.histories.push_back(history);
  }
}

void emit_barriers(const CompileInput& in, const Activation& active,
                   const Subresources& subresources, const Versions& versions,
                   const QueueAssignment& queues, const ResourceMemory& memory,
                   const Histories& histories, const Placements& placements, Report& report,
                   Plan& plan, BarrierScratch& scratch) {
  const BarrierInput input{*in.graph, active, subresources, versions,
                           queues,    memory, histories,    placements};
  scratch.objects.number(subresources, histories, plan);
  scratch.accesses.begin(scratch.objects.states.size());
  scratch.queues.begin(queues.two(), scratch.objects.states.size(), plan.passes.size());
  scratch.drafts.begin(queues.two(), subresources.any() ? plan.resources.size() : 0);
  BarrierWalk walk{input,          report,         plan,          scratch.objects, scratch.accesses,
                   scratch.drafts, scratch.queues, scratch.memory};
  if (scratch.objects.any_history) walk.find_states_at_frame_end();
  walk.locate_resources();
  scratch.queues.add_orderings(*in.graph, active, report, plan);

  scratch.drafts.first_reason = report.reasons.size();
  walk.emit = true;
  for (uint32_t position = 0; position < plan.passes.size(); ++position)
    walk.run_pass(position);
  walk.resolve_aliasing_barriers();
  if (queues.two()) {
    scratch.queues.assign_points(plan);
    scratch.queues.find_round_trips(plan);
    scratch.drafts.drop_covered(scratch.queues, report);
  }
  if (subresources.any()) scratch.drafts.merge_ranges(report);
  scratch.drafts.write_to_plan(!queues.two() && !subresources.any(), report, plan);

  plan.first_final_barrier = static_cast<uint32_t>(plan.barriers.size());
  for (uint32_t r = 0; r < plan.resources.size(); ++r)
    if (walk.info(r).host_owned) walk.pass_to_host(r);
  plan.final_barrier_count = static_cast<uint32_t>(plan.barriers.size()) - plan.first_final_barrier;
  if (scratch.objects.any_history) walk.describe_histories();
}

} // namespace dermis
