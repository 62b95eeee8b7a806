#include "framegraph/verify/subresource_ranges.hpp"

#include <algorithm>

namespace dermis {

std::vector<SubresourceGrid> subresource_grids(const Plan& plan) {
  std::vector<SubresourceGrid> grids(plan.resources.size());
  const auto cut = [&](uint32_t resource, const SubresourceRange& range) {
    SubresourceGrid& own = grids[resource];
    if (range == plan.resources[resource].whole() && !own.mips.empty()) return;
    own.mips.push_back(range.first_mip);
    own.mips.push_back(static_cast<uint16_t>(range.first_mip + range.mips));
    own.layers.push_back(range.first_layer);
    own.layers.push_back(static_cast<uint16_t>(range.first_layer + range.layers));
  };
  for (uint32_t r = 0; r < plan.resources.size(); ++r)
    cut(r, plan.resources[r].whole());
  for (const PlanAccess& access : plan.accesses)
    cut(access.resource, access.range);
  for (const PlanBarrier& barrier : plan.barriers)
    cut(barrier.resource, barrier.range);
  for (const PlanHistory& history : plan.histories)
    for (uint32_t cell = 0; cell < history.range_count; ++cell)
      cut(history.resource, plan.history_ranges[history.first_range + cell]);
  for (SubresourceGrid& own : grids)
    for (std::vector<uint16_t>* cuts : {&own.mips, &own.layers}) {
      std::sort(cuts->begin(), cuts->end());
      cuts->erase(std::unique(cuts->begin(), cuts->end()), cuts->end());
    }
  return grids;
}

std::vector<uint32_t> used_subresource_counts(const Plan& plan,
                                              const std::vector<SubresourceGrid>& grids) {
  std::vector<uint32_t> used(grids.size(), 0);
  std::vector<std::vector<uint8_t>> seen(grids.size());
  const auto use = [&](uint32_t resource, const SubresourceRange& range) {
    if (used[resource] == grids[resource].count()) return;
    seen[resource].resize(grids[resource].count(), 0);
    grids[resource].for_each_in(range, [&](uint32_t cell) {
      used[resource] += seen[resource][cell] == 0 ? 1 : 0;
      seen[resource][cell] = 1;
    });
  };
  for (const PlanAccess& access : plan.accesses)
    use(access.resource, access.range);
  for (const PlanBarrier& barrier : plan.barriers)
    use(barrier.resource, barrier.range);
  return used;
}

bool overlap(const SubresourceRange& a, const SubresourceRange& b) {
  return a.first_mip < b.first_mip + b.mips && b.first_mip < a.first_mip + a.mips &&
         a.first_layer < b.first_layer + b.layers && b.first_layer < a.first_layer + a.layers;
}

} // namespace dermis
