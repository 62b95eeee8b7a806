// What must wait for what. Walks through the frame once, remembering how each object (a resource, or one of
// its earlier frames) stands: every access either finds the contents visible, in the right layout, or gets
// one barrier behind the pass that it waits for and before its own. Only objects of histories are walked
// twice, since they start as the frame before left them.
//
// Barriers share batches where they can: each may stand at any boundary between the pass it waits for and its
// own, and as few boundaries as possible get a batch. That is stabbing intervals with points: in the order of
// their ends, each takes the last point if that lies inside, else its own end becomes the next.

#include "framegraph/compile/barriers/synchronizer.hpp"

#include <algorithm>

namespace dermis {

bool Synchronizer::number_objects() {
  uint32_t objects = 0, deepest = 0;
  c.sync_info.resize(plan.resources.size());
  for (uint32_t r = 0; r < plan.resources.size(); ++r) {
    const PlanResource& resource = plan.resources[r];
    const Lifetime& life = c.lifetimes[resource.declared.value];
    ResourceSyncInfo& of = c.sync_info[r];
    of.first_object = objects;
    of.roles = life.deepest_read + 1;
    of.parts = c.graph->parts ? c.info[resource.declared.value].parts : 1;
    of.own_role = life.updates_oldest ? life.deepest_read : 0;
    of.host_owned = resource.first_instance == no_instance;
    of.image = resource.type == ResourceType::image;
    of.whole = resource.whole();
    objects += of.roles * of.parts;
    deepest = std::max(deepest, life.deepest_read);
  }
  c.states.assign(objects, {});
  c.touch_number.assign(objects, 0);
  c.moments.assign(two_queues() ? objects : 0, {});
  return deepest > 0;
}

void Synchronizer::carry_over() {
  for (uint32_t r = 0; r < plan.resources.size(); ++r) {
    const ResourceSyncInfo& of = info(r);
    for (uint32_t i = of.roles * of.parts; i-- > 0;) {
      const uint32_t back = i / of.parts, part = i % of.parts, object = of.first_object + i;
      c.states[object] = back == 0 ? ObjectState{} : c.ends[object_of(of, back - 1, part)];
      c.states[object].carried = back != 0;
      if (!two_queues()) continue;
      c.moments[object] = back == 0 ? Moments{} : c.moment_ends[object_of(of, back - 1, part)];
      ++c.moments[object].touch.frames_back;
      ++c.moments[object].write.frames_back;
    }
  }
}

void Synchronizer::find_ends() {
  c.ends.assign(c.states.size(), {});
  c.moment_ends = c.moments;
  uint32_t deepest = 1;
  for (uint32_t r = 0; r < plan.resources.size(); ++r)
    deepest = std::max(deepest, roles(r));
  for (uint32_t frame = 0; frame < deepest; ++frame) {
    carry_over();
    for (uint32_t position = 0; position < plan.passes.size(); ++position)
      run_pass(position);
    c.ends = c.states;
    c.moment_ends = c.moments;
  }
  carry_over();
}

void Synchronizer::transfer(const PassTouch& touch, const ObjectState& state, const UsageSet& set,
                            uint32_t position) {
  PlanBarrier release;
  release.resource = touch.resource;
  release.frames_back = touch.frames_back;
  release.range = range_of(info(touch.resource), touch.resource, touch.part);
  release.old_layout = state.layout;
  release.new_layout = touch.layout;
  release.why =
      set.reads ? PlanBarrier::ReasonKind::read_after_write : PlanBarrier::ReasonKind::write_after_write;
  PlanBarrier acquire = release;
  const Scope scope = tail(state);
  release.source_stages = scope.stages;
  release.source_access = scope.access;
  release.transfer = PlanBarrier::Transfer::release;
  acquire.source_stages = acquire.destination_stages = set.stages; // where the wait for the point ends
  acquire.destination_access = set.access;
  acquire.transfer = PlanBarrier::Transfer::acquire;
  for (const PlanBarrier& half : {release, acquire}) {
    const uint32_t index = draft();
    c.drafts[index] = half;
    c.batch_of[index] = half.transfer == PlanBarrier::Transfer::release ? state.last_pass : position;
    c.record_reason(Reason::About::barrier, index, Reason::ReasonKind::dependency, state.last_pass, 0,
                    position);
  }
  need(position, state.last_pass);
}

inline void Synchronizer::run_touch(const PassTouch& touch, uint32_t position) {
  ObjectState& state = c.states[touch.object];
  const UsageSet& set = sets[touch.usages];
  const Layout layout = touch.layout;
  bool waited = true;
  const bool elsewhere = state.touched && state.queue != queue_at(position);
  if (!state.touched) {
    if (emit) arrive(touch, set, layout, position);
  } else if (elsewhere) {
    if (emit) transfer(touch, state, set, position);
  } else {
    const bool must_see = set.reads && (touch.usages & ~sets[state.visible].sees) != 0;
    waited = layout != state.layout || must_see || set.writes;
    if (waited && emit) {
      const uint32_t index = draft();
      PlanBarrier& barrier = c.drafts[index];
      barrier.resource = touch.resource;
      barrier.frames_back = touch.frames_back;
      barrier.range = range_of(info(touch.resource), touch.resource, touch.part);
      dependency(state, set, layout, must_see, barrier);
      c.record_reason(Reason::About::barrier, index, Reason::ReasonKind::dependency, state.last_pass,
                      state.carried ? 1 : 0, position);
      if (two_queues()) { // what only makes a write visible does not wait for those that read it since
        const bool shows =
            barrier.why == PlanBarrier::ReasonKind::read_after_write && !set.writes && layout == state.layout;
        wait_here(index, shows ? c.moments[touch.object].write : c.moments[touch.object].touch);
      }
      if (state.carried) barrier.why = PlanBarrier::ReasonKind::history;
      place(index, state.carried ? no_value : state.last_pass, position);
    }
  }
  const bool transition = !state.touched || elsewhere || layout != state.layout;
  if (two_queues()) {
    Moments& moments = c.moments[touch.object];
    moments.touch = {0, position + 1};
    if (set.writes || transition) moments.write = moments.touch;
  }
  if (set.writes || transition) {
    state.source_stages = set.stages;
    state.source_access = set.access & all_write_access;
    state.readers = 0;
    state.visible = 0;
    state.read_for_sure = false;
  }
  if (!set.writes) {
    if (waited) {
      state.source_access = 0;
      state.visible = static_cast<uint16_t>(state.visible | touch.usages);
    }
    state.readers |= set.stages;
    state.read_for_sure |= touch.certain;
  }
  state.touched = true;
  state.carried = false;
  state.queue = queue_at(position);
  state.layout = layout;
  state.last_pass = position;
}

void Synchronizer::run_pass(uint32_t position) {
  PlanPass& pass = plan.passes[position];
  const uint32_t first_use = c.first_use[pass.declared.value], end = c.first_use[pass.declared.value + 1];
  collect(first_use, end);
  current = position;
  if (emit) add_accesses(pass, first_use, end);
  waiting_parts.clear();
  for (uint32_t i = 0; i < touch_count; ++i)
    run_touch(c.touches[i], position);
  batch_parts(position);
}

void Synchronizer::dependency(const ObjectState& state, const UsageSet& set, Layout layout, bool must_see,
                              PlanBarrier& barrier) const {
  const bool pending = state.source_access != 0;
  const Scope everything = tail(state);
  barrier.source_stages = everything.stages;
  barrier.source_access = everything.access;
  barrier.destination_stages = set.stages;
  barrier.destination_access = set.access;
  barrier.old_layout = state.layout;
  barrier.new_layout = layout;
  if (layout != state.layout) {
    barrier.why = !pending    ? PlanBarrier::ReasonKind::layout
                  : set.reads ? PlanBarrier::ReasonKind::read_after_write
                              : PlanBarrier::ReasonKind::write_after_write;
  } else if (must_see) {
    barrier.why = PlanBarrier::ReasonKind::read_after_write;
    barrier.source_stages = set.writes ? everything.stages | state.source_stages : state.source_stages;
  } else {
    barrier.why =
        pending ? PlanBarrier::ReasonKind::write_after_write : PlanBarrier::ReasonKind::write_after_read;
    // Readers only have to be done: nothing to make visible.
    if (!pending && state.read_for_sure) barrier.destination_access = 0;
  }
}

void Synchronizer::arrive(const PassTouch& touch, const UsageSet& set, Layout layout, uint32_t position) {
  const uint32_t index = draft();
  const ResourceSyncInfo& of = info(touch.resource);
  PlanBarrier& barrier = c.drafts[index];
  uint32_t after = no_value;
  barrier.resource = touch.resource;
  barrier.frames_back = touch.frames_back;
  barrier.range = range_of(of, touch.resource, touch.part);
  barrier.destination_stages = set.stages;
  barrier.destination_access = set.access;
  barrier.new_layout = layout;
  if (of.host_owned) {
    barrier.from_host = true;
    barrier.why = PlanBarrier::ReasonKind::host_before;
    record_reason(index, Reason::ReasonKind::from_host, touch.resource);
  } else if (of.roles > 1) {
    const uint32_t oldest = of.first_object + (of.roles - 1) * of.parts + touch.part;
    const bool in_place = plan.resources[touch.resource].instance_count < of.roles;
    const ObjectState& before = in_place ? c.states[oldest] : c.ends[oldest];
    if (in_place && !before.carried) after = before.last_pass;
    if (c.aliased_memory[touch.resource] != no_value) after = take_over(touch.resource, index);
    wait_for(barrier, tail(before));
    if (two_queues() && before.touched) {
      Moment last = (in_place ? c.moments : c.moment_ends)[oldest].touch;
      if (!in_place) ++last.frames_back;
      wait_here(index, last);
      c.draft_waits[index].layout_kept = in_place && before.layout == layout;
    }
    barrier.why = PlanBarrier::ReasonKind::history;
    record_reason(index, Reason::ReasonKind::oldest_instance, touch.resource);
  } else if (of.parts > 1 && c.arrival_of[touch.resource] != no_value) {
    after = c.arrived_after[touch.resource];
    c.part_arrivals.push_back({index, touch.resource, touch.object});
    record_reason(index, Reason::ReasonKind::first_use, touch.resource);
  } else {
    after = take_over(touch.resource, index);
    if (of.parts > 1) {
      c.arrived_after[touch.resource] = after;
      c.part_arrivals.push_back({index, touch.resource, touch.object});
    }
  }
  place(index, after, position);
}

void Synchronizer::hand_back(uint32_t resource) {
  const ObjectState& end = c.states[info(resource).first_object];
  const Scope scope = tail(end);
  PlanBarrier barrier;
  barrier.resource = resource;
  barrier.range = plan.resources[resource].whole();
  barrier.from_host = !end.touched;
  barrier.to_host = true;
  barrier.source_stages = scope.stages;
  barrier.source_access = scope.access;
  barrier.old_layout = end.layout;
  barrier.why = PlanBarrier::ReasonKind::host_after;
  record_reason(static_cast<uint32_t>(plan.barriers.size()), Reason::ReasonKind::to_host, resource,
                end.touched ? 0 : 1);
  plan.barriers.push_back(barrier);
}

void Synchronizer::describe_histories() {
  for (uint32_t r = 0; r < plan.resources.size(); ++r) {
    if (roles(r) == 1) continue;
    PlanHistory history;
    history.resource = r;
    history.frames = roles(r) - 1;
    history.first_layout = static_cast<uint32_t>(plan.history_layouts.size());
    history.declaration = c.graph->resources[plan.resources[r].declared.value].history;
    history.first_part = static_cast<uint32_t>(plan.history_parts.size());
    history.parts = parts(r);
    for (uint32_t part = 0; part < parts(r); ++part)
      plan.history_parts.push_back(range_of(info(r), r, part));
    plan.history_layouts.insert(plan.history_layouts.end(), parts(r), Layout::undefined);
    for (uint32_t back = 1; back < roles(r); ++back)
      for (uint32_t part = 0; part < parts(r); ++part)
        plan.history_layouts.push_back(c.ends[object_of(info(r), back - 1, part)].layout);
    plan.histories.push_back(history);
  }
}

void synchronize(CompileContext& c) {
  Plan& plan = c.out->plan;
  Synchronizer walk{c, plan, all_usage_sets()};
  const bool histories = walk.number_objects();
  if (histories) walk.find_ends();
  c.arrivals.clear();
  c.part_arrivals.clear();
  c.needs_point.assign(walk.two_queues() ? plan.passes.size() : 0, 0);
  c.draft_waits.clear();
  c.needs_frame_before.assign(c.needs_point.size(), 0);
  if (c.graph->parts) {
    c.arrived_after.assign(plan.resources.size(), no_value);
    c.part_after.assign(plan.resources.size(), no_value);
  }
  c.arrival_of.assign(plan.resources.size(), no_value);
  c.memory.resize(std::max(c.memory.size(), plan.heaps.size()));
  for (uint32_t heap = 0; heap < plan.heaps.size(); ++heap)
    c.memory[heap].assign(1, {0, plan.heaps[heap].size, no_value, 0});
  walk.alias_into_history();
  walk.find_memory();
  keep_orderings(c);
  walk.emit = true;
  c.drafts.clear();
  c.batch_of.clear();
  c.reasons_before = c.out->reasons.size();
  for (uint32_t position = 0; position < plan.passes.size(); ++position)
    walk.run_pass(position);
  walk.settle_arrivals();
  if (walk.two_queues()) {
    number_points(c);
    walk.drop_needless();
  }
  if (c.graph->parts) merge_part_barriers(c);
  walk.sort_into_batches();
  plan.first_final_barrier = static_cast<uint32_t>(plan.barriers.size());
  for (uint32_t r = 0; r < plan.resources.size(); ++r)
    if (walk.info(r).host_owned) walk.hand_back(r);
  plan.final_barrier_count = static_cast<uint32_t>(plan.barriers.size()) - plan.first_final_barrier;
  if (histories) walk.describe_histories();
}

} // namespace dermis
