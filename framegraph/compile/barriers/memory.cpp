// Who had the bytes of a resource before: in this frame, in the frame before, and of what histories lend.

#include "framegraph/compile/barriers/synchronizer.hpp"

#include <algorithm>
#include <array>

namespace dermis {

uint32_t Synchronizer::last_pass(const Segment& of) const {
  uint32_t last = no_value;
  const SyncFacts& own = facts(of.resource);
  for (uint32_t part = 0; part < own.parts; ++part) {
    const ObjectState& state = c.states[own.first_object + of.frames_back * own.parts + part];
    if (state.touched) last = last == no_value ? state.last_pass : std::max(last, state.last_pass);
  }
  return last;
}

uint32_t Synchronizer::take_over(uint32_t resource, uint32_t barrier) {
  const SyncFacts& own = facts(resource);
  const uint32_t memory = own.memory;
  const uint64_t begin = own.begin, end = own.end;
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

std::vector<Segment>::iterator Synchronizer::behind(std::vector<Segment>& segments, uint64_t at) {
  auto first = segments.begin();
  for (auto left = segments.end() - first; left > 0;) { // without a branch that nobody can foretell
    const auto half = left / 2;
    const bool before = first[half].end <= at;
    first += before ? half + 1 : 0;
    left = before ? left - half - 1 : half;
  }
  return first;
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

void Synchronizer::inherit(const Segment& from, uint32_t resource, uint32_t barrier, bool frame_before) {
  const uint32_t first = facts(from.resource).first_object + from.frames_back * parts(from.resource);
  for (uint32_t part = 0; part < parts(from.resource); ++part)
    inherit(c.states[first + part], barrier, frame_before);
  if (from.resource != resource && roles(resource) == 1) c.drafts[barrier].why = PlanBarrier::Why::alias;
  because(barrier, from.resource == resource ? Reason::Why::behind_last_use : Reason::Why::takes_memory,
          from.resource, frame_before ? 1 : 0);
}

void Synchronizer::find_memory() {
  for (uint32_t r = 0; r < plan.resources.size(); ++r) {
    SyncFacts& of = c.sync_facts[r];
    if (of.host_owned) continue;
    const Placement& place = plan.placements[plan.resources[r].first_instance];
    const Loan& loan = c.loans[r];
    of.memory = place.heap;
    of.begin = place.offset;
    if (loan.from != no_value) {
      of.memory = c.lent_memory[loan.from] + (loan.after ? 1 : 0);
      of.begin = loan.offset;
    } else if (c.lent_memory[r] != no_value) {
      of.memory = c.lent_memory[r];
      of.begin = 0;
    }
    of.end = of.begin + place.size;
  }
}

void Synchronizer::lend() {
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

void Synchronizer::settle_arrivals() {
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
    because(arrival.barrier, Reason::Why::behind_last_use, arrival.resource, 1);
  }
}

} // namespace dermis
