// The phase that gives every instance a heap and a place in it.

#include "framegraph/compile/phases.hpp"
#include "framegraph/model/align_up.hpp"

#include <algorithm>

namespace dermis {
namespace {

// Heaps hold instances that are all persistent or all not, and that some memory type suits.
uint32_t group_of(CompileContext& c, bool persistent, uint32_t type_bits) {
  for (uint32_t g = 0; g < c.groups.size(); ++g)
    if (c.groups[g].persistent == persistent &&
        (c.groups[g].type_bits & type_bits & c.device->device_local_type_bits) != 0)
      return g;
  c.groups.push_back({persistent, type_bits, 0, 0});
  return static_cast<uint32_t>(c.groups.size() - 1);
}

bool shares_nothing(const CompileContext& c, const PlanResource& resource) {
  return !c.input->alias || resource.declared == c.input->keep_alive;
}

void make_placements(CompileContext& c) {
  Plan& plan = c.out->plan;
  const auto last_pass = static_cast<uint32_t>(plan.passes.size()) - 1;
  for (uint32_t r = 0; r < plan.resources.size(); ++r) {
    PlanResource& resource = plan.resources[r];
    if (c.host_owned(resource.declared)) continue;
    if (c.history_aliases[r].from != no_value) continue;
    const Interval& life = c.intervals[resource.declared.value];
    const MemoryNeeds& needs = c.needs[r];
    const bool persistent = c.lifetimes[resource.declared.value].deepest_read > 0;
    const uint32_t index = group_of(c, persistent, needs.memory_type_bits);
    MemoryGroup& group = c.groups[index];
    group.type_bits &= needs.memory_type_bits;
    (resource.type == ResourceType::buffer ? group.buffers : group.images) += resource.instance_count;
    resource.first_instance = static_cast<uint32_t>(plan.placements.size());
    const bool whole_frame = persistent || shares_nothing(c, resource);
    for (uint32_t i = 0; i < resource.instance_count; ++i) {
      Placement& placement = plan.placements.emplace_back();
      placement.resource = r;
      placement.heap = index;
      placement.size = needs.size;
      placement.alignment = needs.alignment;
      placement.first_use = whole_frame ? 0 : life.first;
      placement.last_use = whole_frame ? last_pass : life.last;
      placement.persistent = persistent;
    }
  }
}

// Buffers and optimal images that are neighbours within one granule conflict: where both occur, every item
// gets whole granules (VkPhysicalDeviceLimits::bufferImageGranularity).
uint64_t granule_of(const CompileContext& c, const MemoryGroup& group) {
  const bool mixed = group.buffers != 0 && group.images != 0;
  return mixed ? std::max<uint64_t>(c.device->buffer_image_granularity, 1) : 1;
}

void place_group(CompileContext& c, uint32_t index) {
  Plan& plan = c.out->plan;
  const MemoryGroup& group = c.groups[index];
  const uint64_t granule = granule_of(c, group);
  Heap heap;
  heap.persistent = group.persistent;
  heap.memory_type_bits = group.type_bits;
  c.items.clear();
  c.item_placement.clear();
  for (uint32_t p = 0; p < plan.placements.size(); ++p) {
    Placement& placement = plan.placements[p];
    if (placement.heap != index) continue;
    placement.alignment = std::max({placement.alignment, granule, uint64_t{1}});
    heap.alignment = std::max(heap.alignment, placement.alignment);
    const uint64_t size = granule == 1 ? placement.size : align_up(placement.size, granule);
    c.items.push_back({size, placement.alignment, placement.first_use, placement.last_use});
    c.item_placement.push_back(p);
  }
  c.packer.pack(c.items, c.input->packing, c.packing);
  for (size_t i = 0; i < c.items.size(); ++i)
    plan.placements[c.item_placement[i]].offset = c.packing.offsets[i];
  heap.size = c.packing.size;
  heap.max_live_bytes = c.packing.lower_bound;
  (group.persistent ? plan.history_bytes : plan.transient_bytes) += heap.size;
  plan.heaps.push_back(heap);
}

void place_all(CompileContext& c) {
  Plan& plan = c.out->plan;
  c.groups.clear();
  plan.heaps.clear();
  plan.placements.clear();
  plan.transient_bytes = plan.history_bytes = 0;
  make_placements(c);
  for (uint32_t g = 0; g < c.groups.size(); ++g)
    place_group(c, g);
}

// Behind all others: an instance of each borrower for each of its lender's. In frame f the one that is
// written is f mod n, and the one with the oldest frame the next of the n.
void place_aliased(CompileContext& c) {
  Plan& plan = c.out->plan;
  for (uint32_t r = 0; r < plan.resources.size(); ++r) {
    const HistoryAlias& history_alias = c.history_aliases[r];
    if (history_alias.from == no_value) continue;
    PlanResource& resource = plan.resources[r];
    const PlanResource& alias_target = plan.resources[history_alias.from];
    const Interval& life = c.intervals[resource.declared.value];
    resource.first_instance = static_cast<uint32_t>(plan.placements.size());
    resource.instance_count = alias_target.instance_count;
    for (uint32_t i = 0; i < resource.instance_count; ++i) {
      const uint32_t slot = (i + (history_alias.after ? 1 : 0)) % alias_target.instance_count;
      const Placement there = plan.placements[alias_target.first_instance + slot];
      Placement& placement = plan.placements.emplace_back();
      placement.resource = r;
      placement.heap = there.heap;
      placement.offset = there.offset + history_alias.offset;
      placement.size = c.needs[r].size;
      placement.alignment = c.needs[r].alignment;
      placement.first_use = life.first;
      placement.last_use = life.last;
    }
    c.record_reason(Reason::About::resource, resource.declared.value, Reason::ReasonKind::aliases_history,
                    alias_target.declared.value, history_alias.after ? 1 : 0);
  }
}

} // namespace

void pack(CompileContext& c) {
  c.history_aliases.assign(c.out->plan.resources.size(), {});
  place_all(c);
  if (!find_history_aliases(c)) return;
  const uint64_t without = c.out->plan.transient_bytes;
  place_all(c);
  if (c.out->plan.transient_bytes < without) return place_aliased(c);
  c.history_aliases.assign(c.history_aliases.size(), {});
  place_all(c);
}

} // namespace dermis
