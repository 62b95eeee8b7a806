// How the barriers that were found come into batches.

#include "framegraph/compile/barriers/synchronizer.hpp"

#include <algorithm>

namespace dermis {

void Synchronizer::sort_into_batches() {
  if (!two_queues() && !c.graph->parts) { // they stand in order
    for (const uint32_t position : c.batch_of)
      ++plan.passes[position].barrier_count;
    uint32_t first = 0;
    for (PlanPass& pass : plan.passes) {
      pass.first_barrier = first;
      first += pass.barrier_count;
    }
    plan.barriers.swap(c.drafts);
    return;
  }
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

void Synchronizer::drop_needless() {
  find_round_trips(c);
  c.draft_waits.resize(c.drafts.size());
  for (uint32_t i = 0; i < c.drafts.size(); ++i) {
    const PlanBarrier& draft = c.drafts[i];
    const DraftWaits& waits = c.draft_waits[i];
    if (draft.transfer != PlanBarrier::Transfer::none || draft.from_host ||
        (draft.old_layout != draft.new_layout && !waits.layout_kept))
      continue;
    const FrameCounts& done = c.round_trip[c.batch_of[i]];
    bool known = true;
    for (size_t back = 0; back < done.size(); ++back)
      known &= waits.behind[back] <= done[back];
    if (known) c.batch_of[i] = no_value;
  }
  std::vector<Reason>& reasons = c.out->reasons;
  reasons.erase(std::remove_if(reasons.begin() + static_cast<std::ptrdiff_t>(c.reasons_before), reasons.end(),
                               [&](const Reason& one) { return c.batch_of[one.index] == no_value; }),
                reasons.end());
}

} // namespace dermis
