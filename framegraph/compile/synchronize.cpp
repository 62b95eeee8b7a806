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
#include <array>
#include <span>

namespace dermis {

bool Synchronizer::number_objects() {
  uint32_t objects = 0, deepest = 1;
  c.first_object.clear();
  for (uint32_t r = 0; r < plan.resources.size(); ++r) {
    c.first_object.push_back(objects);
    objects += roles(r) * parts(r);
    deepest = std::max(deepest, roles(r));
  }
  c.states.assign(objects, {});
  c.touch_number.assign(objects, 0);
  return deepest > 1;
}

void Synchronizer::carry_over() {
  for (uint32_t r = 0; r < plan.resources.size(); ++r) {
    for (uint32_t part = 1; part < parts(r); ++part)
      c.states[object_of(r, 0, part)] = {};
    for (uint32_t back = roles(r); back-- > 0;) {
      const uint32_t object = c.first_object[r] + back;
      c.states[object] = back == 0 ? ObjectState{} : c.ends[object_of(r, back - 1)];
      c.states[object].carried = back != 0;
    }
  }
}

void Synchronizer::find_ends() {
  c.ends.assign(c.states.size(), {});
  uint32_t deepest = 1;
  for (uint32_t r = 0; r < plan.resources.size(); ++r)
    deepest = std::max(deepest, roles(r));
  for (uint32_t frame = 0; frame < deepest; ++frame) {
    carry_over();
    for (uint32_t position = 0; position < plan.passes.size(); ++position)
      run_pass(position);
    c.ends = c.states;
  }
  carry_over();
}

void Synchronizer::transfer(const PassTouch& touch, const ObjectState& state, const UsageSet& set,
                            uint32_t position) {
  PlanBarrier release;
  release.resource = touch.resource;
  release.frames_back = touch.frames_back;
  release.range = range_of(touch.resource, touch.part);
  release.old_layout = state.layout;
  release.new_layout = touch.layout;
  release.why = set.reads ? PlanBarrier::Why::read_after_write : PlanBarrier::Why::write_after_write;
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
    c.because(Reason::About::barrier, index, Reason::Why::dependency, state.last_pass, 0, position);
  }
  need(position, state.last_pass);
}

Layout Synchronizer::layout_of(const PassTouch& touch) const {
  return plan.resources[touch.resource].type == ResourceType::image ? sets[touch.usages].image_layout
                                                                    : Layout::undefined;
}

void Synchronizer::collect(uint32_t first_use, uint32_t end) {
  c.touches.clear();
  c.touch_of_use.clear();
  for (uint32_t u = first_use; u < end; ++u) {
    const Use& use = c.uses[u];
    c.touch_of_use.push_back(no_value);
    if (use.trouble != Use::Trouble::none) continue;
    const uint32_t resource = c.plan_resource[use.resource.value];
    const uint32_t part = c.part_index(use);
    const uint32_t object = object_of(resource, use.frames_back, part);
    const auto usage = static_cast<uint8_t>(1u << static_cast<uint32_t>(use.usage));
    uint32_t& number = c.touch_number[object];
    if (number < touches_before) { // by an earlier pass
      number = touches_before + static_cast<uint32_t>(c.touches.size());
      c.touches.push_back({object, resource, use.frames_back, 0, false, part, Layout::undefined});
    }
    const uint32_t same = number - touches_before;
    c.touches[same].usages |= usage;
    c.touches[same].certain |= use.when == ReadWhen::always;
    c.touch_of_use.back() = same;
  }
  touches_before += static_cast<uint32_t>(c.touches.size());
  for (PassTouch& touch : c.touches)
    touch.layout = layout_of(touch);
  if (c.graph->parts) unify_layouts(first_use, end);
}

void Synchronizer::unify_layouts(uint32_t first_use, uint32_t end) {
  for (bool again = true; again;) {
    again = false;
    uint32_t before = no_value; // touch of the use before
    for (uint32_t u = first_use; u < end; ++u) {
      const uint32_t touch = c.touch_of_use[u - first_use];
      if (touch != no_value && before != no_value && c.uses[u].binding == c.uses[u - 1].binding &&
          c.touches[touch].layout != c.touches[before].layout) {
        c.touches[touch].layout = c.touches[before].layout = Layout::general;
        again = true;
      }
      before = touch;
    }
  }
}

void Synchronizer::add_accesses(PlanPass& pass, uint32_t first_use, uint32_t end) {
  const std::span<const Port> ports = c.kind(pass.declared).ports;
  pass.first_access = static_cast<uint32_t>(plan.accesses.size());
  for (uint32_t u = first_use; u < end; ++u) {
    const uint32_t touched = c.touch_of_use[u - first_use];
    if (touched == no_value) continue;
    const PassTouch& touch = c.touches[touched];
    const Use& use = c.uses[u];
    const UsageSet& usage = sets[size_t{1} << static_cast<uint32_t>(use.usage)];
    const SubresourceRange range = range_of(touch.resource, touch.part);
    if (u > first_use && use.binding == c.uses[u - 1].binding) { // a further part
      SubresourceRange& seen = plan.accesses.back().range;
      seen.mips = static_cast<uint16_t>(std::max(seen.first_mip + seen.mips, range.first_mip + range.mips) -
                                        seen.first_mip);
      seen.layers = static_cast<uint16_t>(
          std::max(seen.first_layer + seen.layers, range.first_layer + range.layers) - seen.first_layer);
      continue;
    }
    const Use* history = c.history_of(use);
    const bool alone = history && history->trouble != Use::Trouble::none; // nothing to stand in for
    plan.accesses.push_back({use.port, touch.resource, use.frames_back, range, usage.stages, usage.access,
                             touch.layout, use.frames_back > 0 && ports[use.port].own_texels,
                             alone ? ReadWhen::always : use.when});
  }
  pass.access_count = static_cast<uint32_t>(plan.accesses.size()) - pass.first_access;
}

void Synchronizer::batch(uint32_t index, uint32_t after, uint32_t position) {
  if (two_queues()) { // the passes between may be the other queue's
    c.batch_of[index] = position;
    c.draft_after.resize(c.drafts.size(), no_value);
    c.draft_after[index] = after;
    return;
  }
  const bool shared = last_batch != no_value && (after == no_value || after < last_batch);
  if (!shared) last_batch = position;
  c.batch_of[index] = last_batch;
}

uint32_t Synchronizer::draft() {
  c.drafts.emplace_back();
  c.batch_of.push_back(no_value);
  return static_cast<uint32_t>(c.drafts.size() - 1);
}

void Synchronizer::sort_into_batches() {
  const auto released = [&](uint32_t draft) {
    return c.drafts[draft].transfer == PlanBarrier::Transfer::release;
  };
  uint32_t count = 0;
  for (uint32_t i = 0; i < c.drafts.size(); ++i) {
    if (c.batch_of[i] == no_value) continue;
    ++count;
    PlanPass& pass = plan.passes[c.batch_of[i]];
    ++(released(i) ? pass.release_count : pass.barrier_count);
  }
  uint32_t filled = 0;
  for (PlanPass& pass : plan.passes) {
    pass.first_barrier = filled;
    filled += pass.barrier_count + pass.release_count;
  }
  plan.barriers.resize(count);
  c.batch_filled.assign(2 * plan.passes.size(), 0);
  for (uint32_t i = 0; i < c.drafts.size(); ++i) {
    if (c.batch_of[i] == no_value) continue;
    const PlanPass& pass = plan.passes[c.batch_of[i]];
    uint32_t& before = c.batch_filled[2 * size_t{c.batch_of[i]} + (released(i) ? 1 : 0)];
    c.batch_of[i] = pass.first_barrier + (released(i) ? pass.barrier_count : 0) + before++;
    plan.barriers[c.batch_of[i]] = c.drafts[i];
  }
  for (size_t r = c.reasons_before; r < c.out->reasons.size(); ++r)
    c.out->reasons[r].index = c.batch_of[c.out->reasons[r].index];
}

void Synchronizer::run_pass(uint32_t position) {
  PlanPass& pass = plan.passes[position];
  const uint32_t first_use = c.first_use[pass.declared.value], end = c.first_use[pass.declared.value + 1];
  collect(first_use, end);
  current = position;
  if (emit) add_accesses(pass, first_use, end);
  waiting_parts.clear();
  for (const PassTouch& touch : c.touches)
    run_touch(touch, position);
  batch_parts(position);
}

void Synchronizer::batch_parts(uint32_t position) {
  for (const auto& [index, after] : waiting_parts) {
    uint32_t& latest = c.part_after[c.drafts[index].resource];
    if (after != no_value) latest = latest == no_value ? after : std::max(latest, after);
  }
  for (const auto& [index, after] : waiting_parts)
    batch(index, c.part_after[c.drafts[index].resource], position);
  for (const auto& [index, after] : waiting_parts)
    c.part_after[c.drafts[index].resource] = no_value;
}

void Synchronizer::place(uint32_t index, uint32_t after, uint32_t position) {
  if (c.graph->parts && parts(c.drafts[index].resource) > 1)
    waiting_parts.emplace_back(index, after);
  else
    batch(index, after, position);
}

void Synchronizer::run_touch(const PassTouch& touch, uint32_t position) {
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
    PlanBarrier barrier;
    waited = dependency(state, touch.usages, set, layout, barrier);
    if (waited && emit) {
      barrier.resource = touch.resource;
      barrier.frames_back = touch.frames_back;
      barrier.range = range_of(touch.resource, touch.part);
      const uint32_t index = draft();
      c.because(Reason::About::barrier, index, Reason::Why::dependency, state.last_pass,
                state.carried ? 1 : 0, position);
      if (state.carried) barrier.why = PlanBarrier::Why::history;
      c.drafts[index] = barrier;
      place(index, state.carried ? no_value : state.last_pass, position);
    }
  }
  const bool transition = !state.touched || elsewhere || layout != state.layout;
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
      state.visible = static_cast<uint8_t>(state.visible | touch.usages);
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

bool Synchronizer::dependency(const ObjectState& state, uint8_t usages, const UsageSet& set, Layout layout,
                              PlanBarrier& barrier) const {
  const bool pending = state.source_access != 0;
  const bool must_see = set.reads && (usages & ~sets[state.visible].sees) != 0;
  const Scope everything = tail(state);
  barrier.source_stages = everything.stages;
  barrier.source_access = everything.access;
  barrier.destination_stages = set.stages;
  barrier.destination_access = set.access;
  barrier.old_layout = state.layout;
  barrier.new_layout = layout;
  if (layout != state.layout) {
    barrier.why = !pending    ? PlanBarrier::Why::layout
                  : set.reads ? PlanBarrier::Why::read_after_write
                              : PlanBarrier::Why::write_after_write;
    return true;
  }
  if (must_see) {
    barrier.why = PlanBarrier::Why::read_after_write;
    barrier.source_stages = set.writes ? everything.stages | state.source_stages : state.source_stages;
    return true;
  }
  if (!set.writes) return false;
  barrier.why = pending ? PlanBarrier::Why::write_after_write : PlanBarrier::Why::write_after_read;
  // Readers only have to be done: nothing to make visible.
  if (!pending && state.read_for_sure) barrier.destination_access = 0;
  return true;
}

void Synchronizer::arrive(const PassTouch& touch, const UsageSet& set, Layout layout, uint32_t position) {
  const uint32_t index = draft();
  const PlanResource& own = plan.resources[touch.resource];
  PlanBarrier& barrier = c.drafts[index];
  uint32_t after = no_value;
  barrier.resource = touch.resource;
  barrier.frames_back = touch.frames_back;
  barrier.range = range_of(touch.resource, touch.part);
  barrier.destination_stages = set.stages;
  barrier.destination_access = set.access;
  barrier.new_layout = layout;
  if (host_owned(touch.resource)) {
    barrier.from_host = true;
    barrier.why = PlanBarrier::Why::host_before;
    because(index, Reason::Why::from_host, touch.resource);
  } else if (roles(touch.resource) > 1) {
    const uint32_t oldest = c.first_object[touch.resource] + roles(touch.resource) - 1;
    const bool in_place = own.instance_count < roles(touch.resource);
    const ObjectState& before = in_place ? c.states[oldest] : c.ends[oldest];
    if (in_place && !before.carried) after = before.last_pass;
    if (c.lent_memory[touch.resource] != no_value) after = take_over(touch.resource, index);
    wait_for(barrier, tail(before));
    barrier.why = PlanBarrier::Why::history;
    because(index, Reason::Why::oldest_instance, touch.resource);
  } else if (parts(touch.resource) > 1 && c.arrival_of[touch.resource] != no_value) {
    after = c.arrived_after[touch.resource];
    c.part_arrivals.push_back({index, touch.resource, touch.object});
    because(index, Reason::Why::first_use, touch.resource);
  } else {
    after = take_over(touch.resource, index);
    if (parts(touch.resource) > 1) {
      c.arrived_after[touch.resource] = after;
      c.part_arrivals.push_back({index, touch.resource, touch.object});
    }
  }
  place(index, after, position);
}

void Synchronizer::drop_needless() {
  c.waits_here.resize(c.drafts.size());
  c.draft_after.resize(c.drafts.size(), no_value);
  for (uint32_t i = 0; i < c.drafts.size(); ++i) {
    const PlanBarrier& draft = c.drafts[i];
    if (draft.transfer != PlanBarrier::Transfer::none || draft.from_host ||
        draft.old_layout != draft.new_layout)
      continue;
    const uint32_t after = c.draft_after[i] == no_value ? 0 : c.draft_after[i] + 1;
    const uint32_t done = c.round_trip[c.batch_of[i]];
    const bool arrival = c.arrival_of[draft.resource] == i; // of a buffer: images change their layout
    if ((done > 0 && after <= done) || (arrival && !c.waits_here[i])) c.batch_of[i] = no_value;
  }
  std::vector<Reason>& reasons = c.out->reasons;
  reasons.erase(std::remove_if(reasons.begin() + static_cast<std::ptrdiff_t>(c.reasons_before), reasons.end(),
                               [&](const Reason& one) { return c.batch_of[one.index] == no_value; }),
                reasons.end());
}

void Synchronizer::hand_back(uint32_t resource) {
  const ObjectState& end = c.states[c.first_object[resource]];
  const Scope scope = tail(end);
  PlanBarrier barrier;
  barrier.resource = resource;
  barrier.range = plan.resources[resource].whole();
  barrier.from_host = !end.touched;
  barrier.to_host = true;
  barrier.source_stages = scope.stages;
  barrier.source_access = scope.access;
  barrier.old_layout = end.layout;
  barrier.why = PlanBarrier::Why::host_after;
  because(static_cast<uint32_t>(plan.barriers.size()), Reason::Why::to_host, resource, end.touched ? 0 : 1);
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
    plan.history_layouts.push_back(Layout::undefined);
    for (uint32_t back = 1; back < roles(r); ++back)
      plan.history_layouts.push_back(c.ends[object_of(r, back - 1)].layout);
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
  c.waits_here.clear();
  c.draft_after.clear();
  c.needs_frame_before.assign(c.needs_point.size(), 0);
  if (c.graph->parts) {
    c.arrived_after.assign(plan.resources.size(), no_value);
    c.part_after.assign(plan.resources.size(), no_value);
  }
  c.arrival_of.assign(plan.resources.size(), no_value);
  c.memory.resize(std::max(c.memory.size(), plan.heaps.size()));
  for (std::vector<Segment>& segments : c.memory)
    segments.clear();
  walk.lend();
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
    if (walk.host_owned(r)) walk.hand_back(r);
  plan.final_barrier_count = static_cast<uint32_t>(plan.barriers.size()) - plan.first_final_barrier;
  if (histories) walk.describe_histories();
}

} // namespace dermis
