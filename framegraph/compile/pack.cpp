#include "framegraph/compile/pack.hpp"

#include "framegraph/compile/phases.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

namespace dermis {
namespace {

uint64_t align_up(uint64_t value, uint64_t alignment) {
  return (value + alignment - 1) / alignment * alignment;
}

bool meet(uint32_t first_a, uint32_t last_a, uint32_t first_b, uint32_t last_b) {
  return first_a <= last_b && first_b <= last_a;
}

struct Span {
  uint64_t begin, end;
};

// The start of the smallest gap between `taken` (sorted by begin) that holds `item`; behind them all if none
// does.
uint64_t tightest_gap(const PackItem& item, const std::vector<Span>& taken) {
  uint64_t best = UINT64_MAX, best_slack = UINT64_MAX, free_from = 0;
  for (const Span& span : taken) {
    const uint64_t start = align_up(free_from, item.alignment);
    if (start + item.size <= span.begin && span.begin - start - item.size < best_slack) {
      best = start;
      best_slack = span.begin - start - item.size;
    }
    free_from = std::max(free_from, span.end);
  }
  return best != UINT64_MAX ? best : align_up(free_from, item.alignment);
}

Packing place_in_order(const std::vector<PackItem>& items, const std::vector<uint32_t>& order) {
  Packing packing;
  packing.offsets.assign(items.size(), 0);
  std::vector<uint32_t> placed;
  std::vector<Span> taken;
  for (const uint32_t i : order) {
    taken.clear();
    for (const uint32_t p : placed)
      if (meet(items[i].first, items[i].last, items[p].first, items[p].last))
        taken.push_back({packing.offsets[p], packing.offsets[p] + items[p].size});
    std::sort(taken.begin(), taken.end(), [](const Span& a, const Span& b) { return a.begin < b.begin; });
    packing.offsets[i] = tightest_gap(items[i], taken);
    packing.size = std::max(packing.size, packing.offsets[i] + items[i].size);
    placed.push_back(i);
  }
  return packing;
}

// The most bytes alive at once; it changes only where an interval begins.
uint64_t most_alive(const std::vector<PackItem>& items) {
  uint64_t most = 0;
  for (const PackItem& at : items) {
    uint64_t alive = 0;
    for (const PackItem& item : items)
      if (item.first <= at.first && at.first <= item.last) alive += item.size;
    most = std::max(most, alive);
  }
  return most;
}

// One physical instance that wants memory.
struct Want {
  uint32_t placement; // into Plan::placements
  MemoryNeeds needs;
  bool buffer;
};

// Instances that may share a heap: both persistent or both not, and some memory type suits them all.
struct Group {
  bool persistent = false;
  uint32_t type_bits = 0;
  std::vector<Want> wants;
};

MemoryNeeds needs_of(const CompileContext& c, const PlanResource& resource) {
  if (resource.type == ResourceType::buffer)
    return c.device.buffer_needs({resource.bytes, resource.vk_usage});
  return c.device.image_needs(
      {resource.format, resource.width, resource.height, resource.mips, resource.layers, resource.vk_usage});
}

std::vector<Group> group_instances(CompileContext& c) {
  Plan& plan = c.out.plan;
  std::vector<Group> groups;
  for (uint32_t r = 0; r < plan.resources.size(); ++r) {
    PlanResource& resource = plan.resources[r];
    if (c.host_owned(resource.declared)) continue;
    const Lifetime& life = c.lifetimes[resource.declared.value];
    const MemoryNeeds needs = needs_of(c, resource);
    const bool persistent = resource.instance_count > 1;
    auto group = std::find_if(groups.begin(), groups.end(), [&](const Group& candidate) {
      return candidate.persistent == persistent &&
             (candidate.type_bits & needs.memory_type_bits & c.device.device_local_type_bits) != 0;
    });
    if (group == groups.end()) group = groups.insert(group, {persistent, needs.memory_type_bits, {}});
    group->type_bits &= needs.memory_type_bits;
    resource.first_instance = static_cast<uint32_t>(plan.placements.size());
    for (uint32_t i = 0; i < resource.instance_count; ++i) {
      Placement placement;
      placement.resource = r;
      placement.heap = static_cast<uint32_t>(group - groups.begin());
      placement.size = needs.size;
      placement.alignment = needs.alignment;
      placement.first_use = persistent ? 0 : life.first;
      placement.last_use = persistent ? static_cast<uint32_t>(plan.passes.size()) - 1 : life.last;
      placement.persistent = persistent;
      group->wants.push_back(
          {static_cast<uint32_t>(plan.placements.size()), needs, resource.type == ResourceType::buffer});
      plan.placements.push_back(placement);
    }
  }
  return groups;
}

// Buffers and optimal images that are neighbours within one granule conflict: where both occur, every item
// gets whole granules (VkPhysicalDeviceLimits::bufferImageGranularity).
uint64_t granule_of(const CompileContext& c, const Group& group) {
  const auto buffers =
      std::count_if(group.wants.begin(), group.wants.end(), [](const Want& w) { return w.buffer; });
  const bool mixed = buffers != 0 && static_cast<size_t>(buffers) != group.wants.size();
  return mixed ? std::max<uint64_t>(c.device.buffer_image_granularity, 1) : 1;
}

void place_group(CompileContext& c, const Group& group) {
  Plan& plan = c.out.plan;
  const uint64_t granule = granule_of(c, group);
  std::vector<PackItem> items;
  Heap heap;
  heap.persistent = group.persistent;
  heap.memory_type_bits = group.type_bits;
  for (const Want& want : group.wants) {
    const Placement& placement = plan.placements[want.placement];
    const uint64_t alignment = std::max({want.needs.alignment, granule, uint64_t{1}});
    items.push_back({align_up(placement.size, granule), alignment, placement.first_use, placement.last_use});
    heap.alignment = std::max(heap.alignment, alignment);
  }
  const Packing packing = pack_items(items);
  for (size_t i = 0; i < items.size(); ++i) {
    plan.placements[group.wants[i].placement].offset = packing.offsets[i];
    plan.placements[group.wants[i].placement].alignment = items[i].alignment;
  }
  heap.size = packing.size;
  heap.max_live_bytes = packing.lower_bound;
  (group.persistent ? plan.history_bytes : plan.transient_bytes) += heap.size;
  plan.heaps.push_back(heap);
}

bool share_bytes(const Placement& a, const Placement& b) {
  return a.heap == b.heap && a.offset < b.offset + b.size && b.offset < a.offset + a.size;
}

void explain_placements(CompileContext& c) {
  const Plan& plan = c.out.plan;
  const auto name = [&](const Placement& p) { return c.name(plan.resources[p.resource].declared); };
  for (uint32_t i = 0; i < plan.placements.size(); ++i) {
    const Placement& own = plan.placements[i];
    if (own.persistent) {
      c.because(Reason::About::placement, i, "shares no memory: its contents outlive the frame");
      continue;
    }
    std::string shared, apart;
    for (uint32_t k = 0; k < plan.placements.size(); ++k) {
      const Placement& other = plan.placements[k];
      if (k == i || other.heap != own.heap) continue;
      if (share_bytes(own, other))
        shared += fmt::format("{}'{}'", shared.empty() ? "" : ", ", name(other));
      else if (meet(own.first_use, own.last_use, other.first_use, other.last_use))
        apart += fmt::format("{}'{}' [{}, {}]", apart.empty() ? "" : ", ", name(other), other.first_use,
                             other.last_use);
    }
    std::string text = fmt::format("alive in passes [{}, {}]", own.first_use, own.last_use);
    if (!shared.empty()) text += "; shares memory with " + shared;
    if (!apart.empty()) text += "; not with " + apart + ", which live at the same time";
    c.because(Reason::About::placement, i, text);
  }
}

} // namespace

Packing pack_items(const std::vector<PackItem>& items) {
  std::vector<uint32_t> by_size(items.size());
  std::iota(by_size.begin(), by_size.end(), 0u);
  std::vector<uint32_t> by_time = by_size;
  std::stable_sort(by_size.begin(), by_size.end(), [&](uint32_t a, uint32_t b) {
    return items[a].size != items[b].size ? items[a].size > items[b].size : items[a].first < items[b].first;
  });
  std::stable_sort(by_time.begin(), by_time.end(), [&](uint32_t a, uint32_t b) {
    return items[a].first != items[b].first ? items[a].first < items[b].first : items[a].size > items[b].size;
  });
  const uint64_t bound = most_alive(items);
  Packing best = place_in_order(items, by_size);
  if (best.size > bound) {
    Packing other = place_in_order(items, by_time);
    if (other.size < best.size) best = std::move(other);
  }
  best.lower_bound = bound;
  return best;
}

void pack(CompileContext& c) {
  for (const Group& group : group_instances(c))
    place_group(c, group);
  explain_placements(c);
}

} // namespace dermis
