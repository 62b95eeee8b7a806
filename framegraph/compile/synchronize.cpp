// What must wait for what. Walks through the frame once, remembering how each object (a resource, or one of
// its earlier frames) stands: every access either finds the contents visible, in the right layout, or gets
// one barrier behind the pass that it waits for and before its own. Only objects of histories are walked
// twice, since they start as the frame before left them.
//
// Barriers share batches where they can: each may stand at any boundary between the pass it waits for and its
// own, and as few boundaries as possible get a batch. That is stabbing intervals with points: in the order of
// their ends, each takes the last point if that lies inside, else its own end becomes the next.

#include "framegraph/compile/synchronize.hpp"
#include "framegraph/compile/phases.hpp"

#include <algorithm>
#include <array>
#include <span>
#include <utility>

namespace dermis {
namespace {

struct Scope {
  Stage stages = 0;
  Access access = 0;
};

// Where a dependency on everything done so far starts.
Scope tail(const ObjectState& state) {
  if (!state.touched) return {};
  return {state.readers != 0 && state.source_access == 0 ? state.readers
                                                         : state.source_stages | state.readers,
          state.source_access};
}

struct Synchronizer {
  CompileContext& c;
  Plan& plan;
  const std::array<UsageSet, usage_sets>& sets;
  std::vector<std::pair<uint32_t, uint32_t>> waiting_parts =
      {};                         // barriers for parts, and what they stand behind
  uint32_t current = 0;           // position
  bool emit = false;              // barriers; otherwise only how each object ends
  uint32_t last_batch = no_value; // position of the pass behind it

  void because(uint32_t barrier, Reason::Why why, uint32_t resource, uint32_t b = 0) {
    c.because(Reason::About::barrier, barrier, why, plan.resources[resource].declared.value, b);
  }
  bool host_owned(uint32_t resource) const { return plan.resources[resource].first_instance == no_instance; }

  const Lifetime& life(uint32_t resource) const {
    return c.lifetimes[plan.resources[resource].declared.value];
  }
  // Frames of a resource that a frame touches, this one included: each is an object.
  uint32_t roles(uint32_t resource) const { return life(resource).deepest_read + 1; }
  // Parts of a resource that ports tell apart: each is an object. Histories have one.
  uint32_t parts(uint32_t resource) const {
    return c.graph->parts ? c.facts[plan.resources[resource].declared.value].parts : 1;
  }
  // This frame's and the oldest are one object where the one is written over the other.
  uint32_t object_of(uint32_t resource, uint32_t frames_back, uint32_t part = 0) const {
    const bool oldest = frames_back == 0 && life(resource).updates_oldest;
    return c.first_object[resource] + (oldest ? life(resource).deepest_read : frames_back) + part;
  }
  SubresourceRange range_of(uint32_t resource, uint32_t part) const {
    if (parts(resource) == 1) return plan.resources[resource].whole();
    return c.parts[c.part_number(plan.resources[resource].declared, part)];
  }

  // Returns whether the plan has histories.
  bool number_objects() {
    uint32_t objects = 0, deepest = 1;
    c.first_object.clear();
    for (uint32_t r = 0; r < plan.resources.size(); ++r) {
      c.first_object.push_back(objects);
      objects += roles(r) * parts(r);
      deepest = std::max(deepest, roles(r));
    }
    c.states.assign(objects, {});
    return deepest > 1;
  }

  // Earlier frames of a history start where the frame before left them, one role younger; everything else
  // arrives with its first barrier.
  void carry_over() {
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

  // The oldest instance of a history was one role younger when the frame before ended, and so on.
  void find_ends() {
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

  bool two_queues() const { return !c.queue.empty(); }
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
  void transfer(const PassTouch& touch, const ObjectState& state, const UsageSet& set, uint32_t position) {
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

  Layout layout_of(const PassTouch& touch) const {
    return plan.resources[touch.resource].type == ResourceType::image ? sets[touch.usages].image_layout
                                                                      : Layout::undefined;
  }

  // What the pass does to each object; by use: which of them it touches.
  void collect(uint32_t first_use, uint32_t end) {
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
      uint32_t same = 0;
      while (same < c.touches.size() && c.touches[same].object != object)
        ++same;
      if (same == c.touches.size())
        c.touches.push_back({object, resource, use.frames_back, 0, false, part, Layout::undefined});
      c.touches[same].usages |= usage;
      c.touches[same].certain |= use.when == ReadWhen::always;
      c.touch_of_use.back() = same;
    }
    for (PassTouch& touch : c.touches)
      touch.layout = layout_of(touch);
    if (c.graph->parts) unify_layouts(first_use, end);
  }

  // A port sees all its parts in one layout: `general` where they would have several.
  void unify_layouts(uint32_t first_use, uint32_t end) {
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

  void add_accesses(PlanPass& pass, uint32_t first_use, uint32_t end) {
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

  // Adds a barrier for the pass at `position` that waits for nothing of this frame behind the pass at
  // `after`.
  void batch(uint32_t index, uint32_t after, uint32_t position) {
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

  uint32_t draft() {
    c.drafts.emplace_back();
    c.batch_of.push_back(no_value);
    return static_cast<uint32_t>(c.drafts.size() - 1);
  }

  // Brings the drafts into the order of their batches, those of one batch as they were found.
  void sort_into_batches() {
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

  void run_pass(uint32_t position) {
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

  // Barriers for parts of one image stand in one batch, so that they can become one barrier.
  void batch_parts(uint32_t position) {
    for (const auto& [index, after] : waiting_parts) {
      uint32_t& latest = c.part_after[c.drafts[index].resource];
      if (after != no_value) latest = latest == no_value ? after : std::max(latest, after);
    }
    for (const auto& [index, after] : waiting_parts)
      batch(index, c.part_after[c.drafts[index].resource], position);
    for (const auto& [index, after] : waiting_parts)
      c.part_after[c.drafts[index].resource] = no_value;
  }

  void place(uint32_t index, uint32_t after, uint32_t position) {
    if (c.graph->parts && parts(c.drafts[index].resource) > 1)
      waiting_parts.emplace_back(index, after);
    else
      batch(index, after, position);
  }

  void run_touch(const PassTouch& touch, uint32_t position) {
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

  // Fills in the barrier that an access needs behind `state`; false if it needs none.
  bool dependency(const ObjectState& state, uint8_t usages, const UsageSet& set, Layout layout,
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

  void wait_for(PlanBarrier& barrier, const Scope& scope) const {
    barrier.source_stages |= scope.stages;
    barrier.source_access |= scope.access;
  }

  // The first barrier of an object whose old contents do not count.
  void arrive(const PassTouch& touch, const UsageSet& set, Layout layout, uint32_t position) {
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

  // The last pass of this frame that touched any part of the resource.
  uint32_t last_pass(const Segment& of) const {
    uint32_t last = no_value;
    for (uint32_t part = 0; part < parts(of.resource); ++part) {
      const ObjectState& state = c.states[c.first_object[of.resource] + of.frames_back + part];
      if (state.touched) last = last == no_value ? state.last_pass : std::max(last, state.last_pass);
    }
    return last;
  }

  // Memory passes from those that had its bytes before in this frame; where there is none, from those that
  // had them last in the frame before, which are known when the walk is over. Earlier ones than the last had
  // to be done before it: the wait reaches them through it.
  // Returns the last pass of this frame that had any of them, no_value if none had.
  uint32_t take_over(uint32_t resource, uint32_t barrier) {
    const auto [memory, begin, end] = memory_of(resource);
    std::vector<Segment>& segments = c.memory[memory];
    if (roles(resource) == 1) { // histories say what they wait for themselves
      because(barrier, Reason::Why::first_use, resource);
      c.arrival_of[resource] = barrier;
    }
    const auto first = behind(segments, begin);
    auto last = first;
    uint64_t reached = begin;
    uint32_t after = no_value;
    for (; last != segments.end() && last->begin < end; ++last) {
      if (last->begin > reached) c.arrivals.push_back({reached, last->begin, memory, barrier, resource});
      inherit(*last, resource, barrier, false);
      const uint32_t ended = last_pass(*last);
      after = after == no_value ? ended : std::max(after, ended);
      reached = last->end;
    }
    if (reached < end) c.arrivals.push_back({reached, end, memory, barrier, resource});
    // What is left of the first and the last of them stays.
    std::array<Segment, 3> pieces;
    size_t count = 0;
    if (first != last && first->begin < begin)
      pieces[count++] = {first->begin, begin, first->resource, first->frames_back};
    pieces[count++] = {begin, end, resource, 0};
    if (first != last && (last - 1)->end > end)
      pieces[count++] = {end, (last - 1)->end, (last - 1)->resource, (last - 1)->frames_back};
    const auto replaced = static_cast<size_t>(last - first);
    const size_t in_place = std::min(replaced, count);
    std::copy_n(pieces.begin(), in_place, first);
    if (replaced > count)
      segments.erase(first + static_cast<std::ptrdiff_t>(count), last);
    else
      segments.insert(first + static_cast<std::ptrdiff_t>(in_place),
                      pieces.begin() + static_cast<std::ptrdiff_t>(in_place),
                      pieces.begin() + static_cast<std::ptrdiff_t>(count));
    return after;
  }

  // The first segment that ends behind `at`.
  static std::vector<Segment>::iterator behind(std::vector<Segment>& segments, uint64_t at) {
    auto first = segments.begin();
    for (auto left = segments.end() - first; left > 0;) { // without a branch that nobody can foretell
      const auto half = left / 2;
      const bool before = first[half].end <= at;
      first += before ? half + 1 : 0;
      left = before ? left - half - 1 : half;
    }
    return first;
  }

  void inherit(const ObjectState& state, uint32_t barrier, bool frame_before) {
    const uint32_t position = c.batch_of[barrier] == no_value ? current : c.batch_of[barrier];
    if (two_queues() && state.touched && state.queue != queue_at(position))
      return wait_elsewhere(c.drafts[barrier], position, state.last_pass, frame_before);
    wait_for(c.drafts[barrier], tail(state));
    if (!two_queues() || !state.touched) return;
    c.waits_here.resize(c.drafts.size());
    c.waits_here[barrier] = 1;
  }

  // Barriers that change no layout, and whose work the waits for points do: those behind which the other
  // queue has waited, and this one for it; and those of buffers that take over what the other queue had
  // alone.
  void drop_needless() {
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
    reasons.erase(std::remove_if(reasons.begin() + static_cast<std::ptrdiff_t>(c.reasons_before),
                                 reasons.end(),
                                 [&](const Reason& one) { return c.batch_of[one.index] == no_value; }),
                  reasons.end());
  }

  // Behind the wait for a point, which ends where the barrier begins.
  void wait_elsewhere(PlanBarrier& barrier, uint32_t position, uint32_t earlier, bool frame_before) {
    barrier.source_stages |= barrier.destination_stages;
    frame_before ? need_frame_before(position, earlier) : need(position, earlier);
  }

  void inherit(const Segment& from, uint32_t resource, uint32_t barrier, bool frame_before) {
    const uint32_t first = c.first_object[from.resource] + from.frames_back;
    for (uint32_t part = 0; part < parts(from.resource); ++part)
      inherit(c.states[first + part], barrier, frame_before);
    if (from.resource != resource && roles(resource) == 1) c.drafts[barrier].why = PlanBarrier::Why::alias;
    because(barrier, from.resource == resource ? Reason::Why::behind_last_use : Reason::Why::takes_memory,
            from.resource, frame_before ? 1 : 0);
  }

  // The bytes in which a resource arrives. What a history lends is memory of its own, twice: before it is
  // written, and after the last read of its oldest frame. The instance of the latter is that of the former in
  // the next frame.
  struct MemoryRange {
    uint32_t memory = 0; // into c.memory
    uint64_t begin = 0, end = 0;
  };
  MemoryRange memory_of(uint32_t resource) const {
    const Placement& place = plan.placements[plan.resources[resource].first_instance];
    const Loan& loan = c.loans[resource];
    if (loan.from != no_value)
      return {c.lent_memory[loan.from] + (loan.after ? 1 : 0), loan.offset, loan.offset + place.size};
    if (c.lent_memory[resource] != no_value) return {c.lent_memory[resource], 0, place.size};
    return {place.heap, place.offset, place.offset + place.size};
  }

  // The memory that histories lend: the oldest frame has it first.
  void lend() {
    auto memory = static_cast<uint32_t>(plan.heaps.size());
    c.lent_memory.assign(plan.resources.size(), no_value);
    for (const Loan& loan : c.loans) {
      if (loan.from == no_value || c.lent_memory[loan.from] != no_value) continue;
      c.lent_memory[loan.from] = memory;
      memory += 2;
      c.memory.resize(std::max<size_t>(c.memory.size(), memory));
      c.memory[memory - 2].clear();
      const uint64_t size = plan.placements[plan.resources[loan.from].first_instance].size;
      c.memory[memory - 1].assign(1, {0, size, loan.from, roles(loan.from) - 1});
    }
  }

  // A resource's own last use in the frame before counts wherever the others lie: a plan whose placements are
  // moved apart stays in order.
  void settle_arrivals() {
    for (uint32_t r = 0; r < c.arrival_of.size(); ++r)
      if (c.arrival_of[r] != no_value && parts(r) == 1) inherit({0, 0, r, 0}, r, c.arrival_of[r], true);
    for (const Arrival& arrival : c.arrivals) {
      const bool lent = arrival.memory >= plan.heaps.size(); // in the frame before, the instance beside it
      std::vector<Segment>& segments = c.memory[arrival.memory + (lent ? 1 : 0)];
      for (auto at = behind(segments, arrival.begin); at != segments.end() && at->begin < arrival.end; ++at)
        if (at->resource != arrival.resource) inherit(*at, arrival.resource, arrival.barrier, true);
    }
    settle_parts();
  }

  // Each part waits for those that had the memory before, and for its own last use in the frame before.
  void settle_parts() {
    for (size_t i = c.part_arrivals.size();
         i-- > 0;) { // the first of a resource, from which others take, last
      const PartArrival& arrival = c.part_arrivals[i];
      PlanBarrier& barrier = c.drafts[arrival.barrier];
      const PlanBarrier& first = c.drafts[c.arrival_of[arrival.resource]];
      if (&barrier != &first) {
        wait_for(barrier, {first.source_stages, first.source_access});
        barrier.why = first.why;
      }
      inherit(c.states[arrival.object], arrival.barrier, true);
      because(arrival.barrier, Reason::Why::behind_last_use, arrival.resource, 1);
    }
  }

  // Every slot is handed back in the state the host asked for, also one that no pass touched.
  void hand_back(uint32_t resource) {
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

  void describe_histories() {
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
};

} // namespace

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
