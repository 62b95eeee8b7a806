// Places barriers into batches, merges ranges, and drops barriers that the waits between queues
// cover.

#include "framegraph/compile/barrier_drafts.hpp"

#include <algorithm>
#include <set>
#include <tuple>

namespace dermis {
namespace {

bool unite(SubresourceRange& a, const SubresourceRange& b) {
  if (a.first_layer == b.first_layer && a.layers == b.layers &&
      a.first_mip + a.mips == b.first_mip) {
    a.mips = static_cast<uint16_t>(a.mips + b.mips);
    return true;
  }
  if (a.first_mip == b.first_mip && a.mips == b.mips && a.first_layer + a.layers == b.first_layer) {
    a.layers = static_cast<uint16_t>(a.layers + b.layers);
    return true;
  }
  return false;
}

// Extends `a` by the range of `b` if the barriers differ only in their ranges, and those are
// adjacent.
bool merge(PlanBarrier& a, const PlanBarrier& b) {
  const auto all_but_range = [](const PlanBarrier& one) {
    return std::tuple(one.resource, one.frames_back, one.source_stages, one.destination_stages,
                      one.source_access, one.destination_access, one.old_layout, one.new_layout,
                      one.why, one.from_host, one.to_host, one.transfer);
  };
  return all_but_range(a) == all_but_range(b) && unite(a.range, b.range);
}

// Removes the reasons of this phase for which remove(reason) holds.
template <class Remove>
void remove_reasons(std::vector<Reason>& reasons, size_t first, Remove remove) {
  reasons.erase(
      std::remove_if(reasons.begin() + static_cast<std::ptrdiff_t>(first), reasons.end(), remove),
      reasons.end());
}

} // namespace

void BarrierDrafts::begin(bool two, size_t resources) {
  barriers.clear();
  batch_of.clear();
  last_batch = invalid_index;
  first_reason = 0;
  two_queues = two;
  deferred.clear();
  latest_predecessor.assign(resources, invalid_index);
}

void BarrierDrafts::place_deferred(uint32_t position) {
  for (const auto& [draft, predecessor] : deferred) {
    uint32_t& latest = latest_predecessor[barriers[draft].resource];
    if (predecessor != invalid_index)
      latest = latest == invalid_index ? predecessor : std::max(latest, predecessor);
  }
  for (const auto& [draft, predecessor] : deferred)
    place(draft, latest_predecessor[barriers[draft].resource], position);
  for (const auto& [draft, predecessor] : deferred)
    latest_predecessor[barriers[draft].resource] = invalid_index;
}

void BarrierDrafts::drop_covered(const QueueSync& queues, Report& report) {
  const OwnQueueWait no_wait;
  for (uint32_t i = 0; i < barriers.size(); ++i) {
    const PlanBarrier& barrier = barriers[i];
    const OwnQueueWait& wait = i < queues.draft_waits.size() ? queues.draft_waits[i] : no_wait;
    const bool changes_layout = barrier.old_layout != barrier.new_layout && !wait.layout_kept;
    if (barrier.transfer != PlanBarrier::Transfer::none || barrier.from_host || changes_layout)
      continue;
    const FrameCounts& complete = queues.round_trips[batch_of[i]];
    bool covered = true;
    for (size_t back = 0; back < complete.size(); ++back)
      covered &= wait.ends[back] <= complete[back];
    if (covered) batch_of[i] = invalid_index;
  }
  remove_reasons(report.reasons, first_reason,
                 [&](const Reason& reason) { return batch_of[reason.index] == invalid_index; });
}

void BarrierDrafts::merge_ranges(Report& report) {
  std::vector<uint32_t> kept, merged_into(barriers.size());
  for (uint32_t i = 0; i < barriers.size(); ++i) {
    kept.push_back(i);
    merged_into[i] = i;
    while (kept.size() > 1) {
      const uint32_t earlier = kept[kept.size() - 2], later = kept.back();
      if (batch_of[earlier] != batch_of[later] || !merge(barriers[earlier], barriers[later])) break;
      merged_into[later] = earlier;
      kept.pop_back();
    }
  }
  std::vector<uint32_t> new_index(barriers.size()); // by draft
  for (uint32_t k = 0; k < kept.size(); ++k) {
    new_index[kept[k]] = k;
    barriers[k] = barriers[kept[k]];
    batch_of[k] = batch_of[kept[k]];
  }
  for (uint32_t i = 0; i < merged_into.size(); ++i)
    if (merged_into[i] != i) new_index[i] = new_index[merged_into[i]];
  barriers.resize(kept.size());
  batch_of.resize(kept.size());
  for (size_t i = first_reason; i < report.reasons.size(); ++i)
    report.reasons[i].index = new_index[report.reasons[i].index];
  // Merged barriers may have equal reasons, of which one is enough.
  using Key = std::tuple<uint32_t, Reason::ReasonKind, uint32_t, uint32_t, uint32_t>;
  std::set<Key> seen;
  remove_reasons(report.reasons, first_reason, [&](const Reason& reason) {
    return !seen.insert({reason.index, reason.why, reason.a, reason.b, reason.c}).second;
  });
}

void BarrierDrafts::write_to_plan(bool in_order, Report& report, Plan& plan) {
  if (in_order) {
    for (const uint32_t position : batch_of)
      ++plan.passes[position].barrier_count;
    uint32_t first = 0;
    for (PlanPass& pass : plan.passes) {
      pass.first_barrier = first;
      first += pass.barrier_count;
    }
    plan.barriers.swap(barriers);
    return;
  }
  const auto is_release = [&](uint32_t draft) {
    return barriers[draft].transfer == PlanBarrier::Transfer::release;
  };
  uint32_t count = 0;
  for (uint32_t i = 0; i < barriers.size(); ++i) {
    if (batch_of[i] == invalid_index) continue;
    ++count;
    PlanPass& pass = plan.passes[batch_of[i]];
    ++(is_release(i) ? pass.release_count : pass.barrier_count);
  }
  uint32_t filled = 0;
  for (PlanPass& pass : plan.passes) {
    pass.first_barrier = filled;
    filled += pass.barrier_count + pass.release_count;
  }
  plan.barriers.resize(count);
  batch_filled.assign(2 * plan.passes.size(), 0);
  for (uint32_t i = 0; i < barriers.size(); ++i) {
    if (batch_of[i] == invalid_index) continue;
    const PlanPass& pass = plan.passes[batch_of[i]];
    uint32_t& in_batch = batch_filled[2 * size_t{batch_of[i]} + (is_release(i) ? 1 : 0)];
    batch_of[i] = pass.first_barrier + (is_release(i) ? pass.barrier_count : 0) + in_batch++;
    plan.barriers[batch_of[i]] = barriers[i];
  }
  for (size_t r = first_reason; r < report.reasons.size(); ++r)
    report.reasons[r].index = batch_of[report.reasons[r].index];
}

} // namespace dermis
