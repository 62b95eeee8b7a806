// Who had the bytes of a resource before: in this frame, in the frame before, and of what histories lend.

#include "framegraph/compile/barriers/synchronizer.hpp"

#include <algorithm>

namespace dermis {

uint32_t Synchronizer::inherit_parts(const ResourceSyncInfo& of, const ObjectState* state, uint32_t barrier,
                                     bool frame_before) {
  uint32_t last = 0;
  for (uint32_t part = 0; part < of.parts; ++part, ++state) {
    inherit(*state, barrier, frame_before);
    if (state->touched) last = std::max(last, state->last_pass + 1);
  }
  return last;
}

inline uint32_t Synchronizer::inherit(const Segment& from, uint32_t resource, uint32_t barrier,
                                      bool frame_before) {
  const ResourceSyncInfo& of = info(from.resource);
  const ObjectState* state = c.states.data() + of.first_object + from.frames_back * of.parts;
  PlanBarrier& draft = c.drafts[barrier];
  uint32_t last = 0;
  if (of.parts == 1 && !two_queues()) {
    wait_for(draft, tail(*state));
    last = state->touched ? state->last_pass + 1 : 0;
  } else {
    last = inherit_parts(of, state, barrier, frame_before);
  }
  const bool own = from.resource == resource;
  if (!own && roles(resource) == 1) draft.why = PlanBarrier::ReasonKind::alias;
  record_reason(barrier, own ? Reason::ReasonKind::behind_last_use : Reason::ReasonKind::takes_memory,
                from.resource, frame_before ? 1 : 0);
  return last;
}

uint32_t Synchronizer::take_over(uint32_t resource, uint32_t barrier) {
  const ResourceSyncInfo& own = info(resource);
  std::vector<Segment>& segments = c.memory[own.memory];
  if (own.roles == 1) { // histories say what they wait for themselves
    record_reason(barrier, Reason::ReasonKind::first_use, resource);
    c.arrival_of[resource] = barrier;
  }
  const size_t first = behind(segments, own.begin);
  size_t last = first;
  uint32_t after = 0; // and one more
  for (; last < segments.size() && segments[last].begin < own.end; ++last) {
    const Segment& before = segments[last];
    if (before.resource == no_value) {
      c.arrivals.push_back(
          {std::max(own.begin, before.begin), std::min(own.end, before.end), own.memory, barrier, resource});
      continue;
    }
    after = std::max(after, inherit(before, resource, barrier, false));
  }
  // What is left of the first and the last of them stays. What there is not is written over by what is.
  Segment left = segments[first], right = segments[last - 1];
  const auto has_left = static_cast<size_t>(left.begin < own.begin);
  const auto has_right = static_cast<size_t>(right.end > own.end);
  left.end = own.begin;
  right.begin = own.end;
  const size_t pieces = 1 + has_left + has_right, replaced = last - first;
  const auto end = segments.begin() + static_cast<std::ptrdiff_t>(last);
  if (replaced > pieces)
    segments.erase(end - static_cast<std::ptrdiff_t>(replaced - pieces), end);
  else if (replaced < pieces)
    segments.insert(end, pieces - replaced, {});
  segments[first] = left;
  segments[first + has_left + has_right] = right;
  segments[first + has_left] = {own.begin, own.end, resource, 0};
  return after - 1;
}

size_t Synchronizer::behind(const std::vector<Segment>& segments, uint64_t at) {
  constexpr size_t few = 16; // are counted: nobody can foretell where a search would turn
  size_t first = 0, left = segments.size();
  while (left > few) {
    const size_t half = left / 2;
    first += pick(segments[first + half].end <= at, half, size_t{0});
    left -= half;
  }
  size_t count = 0;
  for (size_t i = first; i < first + left; ++i)
    count += static_cast<size_t>(segments[i].end <= at);
  return first + count;
}

void Synchronizer::inherit(const ObjectState& state, uint32_t barrier, bool frame_before) {
  if (!two_queues() || !state.touched) return wait_for(c.drafts[barrier], tail(state));
  const uint32_t position = c.batch_of[barrier] == no_value ? current : c.batch_of[barrier];
  if (state.queue != queue_at(position))
    return wait_elsewhere(c.drafts[barrier], position, state.last_pass, frame_before);
  wait_for(c.drafts[barrier], tail(state));
  wait_here(barrier, {frame_before ? 1u : 0u, state.last_pass + 1});
}

void Synchronizer::wait_here(uint32_t barrier, const Moment& behind) {
  if (!two_queues()) return;
  c.draft_waits.resize(c.drafts.size());
  FrameCounts& counts = c.draft_waits[barrier].behind;
  const size_t oldest = counts.size() - 1; // who knows anything of it knows all before
  if (behind.frames_back > oldest)
    counts[oldest] = std::max(counts[oldest], 1u);
  else
    counts[behind.frames_back] = std::max(counts[behind.frames_back], behind.end);
}

void Synchronizer::wait_elsewhere(PlanBarrier& barrier, uint32_t position, uint32_t earlier,
                                  bool frame_before) {
  barrier.source_stages |= barrier.destination_stages;
  frame_before ? need_frame_before(position, earlier) : need(position, earlier);
}

void Synchronizer::find_memory() {
  for (uint32_t r = 0; r < plan.resources.size(); ++r) {
    ResourceSyncInfo& of = c.sync_info[r];
    if (of.host_owned) continue;
    const Placement& place = plan.placements[plan.resources[r].first_instance];
    const HistoryAlias& history_alias = c.history_aliases[r];
    of.memory = place.heap;
    of.begin = place.offset;
    if (history_alias.from != no_value) {
      of.memory = c.aliased_memory[history_alias.from] + (history_alias.after ? 1 : 0);
      of.begin = history_alias.offset;
    } else if (c.aliased_memory[r] != no_value) {
      of.memory = c.aliased_memory[r];
      of.begin = 0;
    }
    of.end = of.begin + place.size;
  }
}

void Synchronizer::alias_into_history() {
  auto memory = static_cast<uint32_t>(plan.heaps.size());
  c.aliased_memory.assign(plan.resources.size(), no_value);
  for (const HistoryAlias& history_alias : c.history_aliases) {
    if (history_alias.from == no_value || c.aliased_memory[history_alias.from] != no_value) continue;
    c.aliased_memory[history_alias.from] = memory;
    memory += 2;
    c.memory.resize(std::max<size_t>(c.memory.size(), memory));
    const uint64_t size = plan.placements[plan.resources[history_alias.from].first_instance].size;
    c.memory[memory - 2].assign(1, {0, size, no_value, 0});
    c.memory[memory - 1].assign(1, {0, size, history_alias.from, roles(history_alias.from) - 1});
  }
}

void Synchronizer::settle_arrivals() {
  for (uint32_t r = 0; r < c.arrival_of.size(); ++r)
    if (c.arrival_of[r] != no_value && parts(r) == 1) inherit({0, 0, r, 0}, r, c.arrival_of[r], true);
  for (const Arrival& arrival : c.arrivals) {
    const bool aliased = arrival.memory >= plan.heaps.size(); // in the frame before, the instance beside it
    std::vector<Segment>& segments = c.memory[arrival.memory + (aliased ? 1 : 0)];
    for (size_t i = behind(segments, arrival.begin); i < segments.size() && segments[i].begin < arrival.end;
         ++i)
      if (segments[i].resource != arrival.resource && segments[i].resource != no_value)
        inherit(segments[i], arrival.resource, arrival.barrier, true);
  }
  settle_parts();
}

void Synchronizer::settle_parts() {
  for (size_t i = c.part_arrivals.size(); i-- > 0;) { // the first of a resource, from which others take, last
    const PartArrival& arrival = c.part_arrivals[i];
    PlanBarrier& barrier = c.drafts[arrival.barrier];
    const PlanBarrier& first = c.drafts[c.arrival_of[arrival.resource]];
    if (&barrier != &first) {
      wait_for(barrier, {first.source_stages, first.source_access});
      if (two_queues()) {
        c.draft_waits.resize(c.drafts.size());
        c.draft_waits[arrival.barrier] = c.draft_waits[c.arrival_of[arrival.resource]];
      }
      barrier.why = first.why;
    }
    inherit(c.states[arrival.object], arrival.barrier, true);
    record_reason(arrival.barrier, Reason::ReasonKind::behind_last_use, arrival.resource, 1);
  }
}

} // namespace dermis
