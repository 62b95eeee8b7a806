#include "framegraph/compile/shared_heaps.hpp"

#include "framegraph/model/align_up.hpp"

#include <algorithm>

namespace dermis {
namespace {

bool has_history(const Plan& plan, ResourceId declared) {
  return std::any_of(plan.histories.begin(), plan.histories.end(), [&](const PlanHistory& one) {
    return plan.resources[one.resource].declared == declared;
  });
}

// Returns whether no other plan has a history of the heap.
bool is_only_here(std::span<const Plan* const> plans, size_t p, uint32_t heap) {
  const Plan& plan = *plans[p];
  for (const PlanHistory& history : plan.histories) {
    const PlanResource& resource = plan.resources[history.resource];
    if (resource.first_instance == no_instance ||
        plan.placements[resource.first_instance].heap != heap)
      continue;
    for (size_t other = 0; other < plans.size(); ++other)
      if (other != p && has_history(*plans[other], resource.declared)) return false;
  }
  return true;
}

uint32_t block_for(SharedHeaps& shared, uint32_t memory_type_bits) {
  uint32_t number = 0;
  while (number < shared.blocks.size() &&
         shared.blocks[number].memory_type_bits != memory_type_bits)
    ++number;
  if (number == shared.blocks.size()) shared.blocks.push_back({memory_type_bits});
  return number;
}

// Places the heaps of a plan; `shares` is by heap.
void place(const Plan& plan, const std::vector<bool>& shares, const HeapAlignment& alignment_of,
           SharedHeaps& shared) {
  std::vector<SharedPlace>& places = shared.places.emplace_back(plan.heaps.size());
  std::vector<uint64_t> ends; // of the plan's heaps, by block
  for (uint32_t h = 0; h < plan.heaps.size(); ++h) {
    const Heap& heap = plan.heaps[h];
    if (!shares[h]) continue;
    const uint32_t number = block_for(shared, heap.memory_type_bits);
    ends.resize(shared.blocks.size(), 0);
    SharedBlock& block = shared.blocks[number];
    const uint64_t alignment = alignment_of ? alignment_of(plan, h) : heap.alignment;
    places[h] = {number, align_up(ends[number], alignment)};
    ends[number] = places[h].offset + heap.size;
    block.bytes = std::max(block.bytes, ends[number]);
    block.alignment = std::max(block.alignment, alignment);
    block.history = block.history || heap.persistent;
  }
}

SharedHeaps place_all(std::span<const Plan* const> plans, HistoryMemory histories,
                      const HeapAlignment& alignment_of) {
  SharedHeaps shared;
  for (size_t p = 0; p < plans.size(); ++p) {
    const Plan& plan = *plans[p];
    std::vector<bool> shares(plan.heaps.size(), false);
    for (uint32_t h = 0; plans.size() > 1 && h < plan.heaps.size(); ++h)
      shares[h] = !plan.heaps[h].persistent ||
                  (histories == HistoryMemory::shared && is_only_here(plans, p, h));
    place(plan, shares, alignment_of, shared);
    for (uint32_t h = 0; h < plan.heaps.size(); ++h)
      if (!shares[h])
        (plan.heaps[h].persistent ? shared.history_bytes : shared.transient_bytes) +=
            plan.heaps[h].size;
  }
  for (const SharedBlock& block : shared.blocks)
    (block.history ? shared.history_bytes : shared.transient_bytes) += block.bytes;
  return shared;
}

uint64_t bytes_of(const SharedHeaps& heaps) {
  return heaps.transient_bytes + heaps.history_bytes;
}

} // namespace

SharedHeaps share_heaps(std::span<const Plan* const> plans, HistoryMemory histories,
                        const HeapAlignment& alignment_of) {
  SharedHeaps separate = place_all(plans, HistoryMemory::separate, alignment_of);
  if (histories == HistoryMemory::separate) return separate;
  SharedHeaps shared = place_all(plans, HistoryMemory::shared, alignment_of);
  return bytes_of(shared) < bytes_of(separate) ? shared : separate;
}

} // namespace dermis
