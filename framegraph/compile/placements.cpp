// Gives every resource instance a heap and an offset. Transients alias each other if their
// lifetimes do not overlap, and they alias idle memory of histories if that shrinks the transient
// heaps.

#include "framegraph/compile/placements.hpp"
#include "framegraph/model/align_up.hpp"

#include <algorithm>

namespace dermis {
namespace {

struct Placer {
  const CompileInput& in;
  const Sizes& sizes;
  const ResourceMemory& memory;
  const Schedule& schedule;
  const Histories& histories;
  Report& report;
  Plan& plan;
  PlacementScratch& scratch;
  Placements& placements = scratch.result;

  // Returns the group for an instance. The instances of a heap are all persistent or all transient
  // and have a memory type in common.
  uint32_t group_of(bool persistent, uint32_t type_bits) {
    for (uint32_t g = 0; g < scratch.groups.size(); ++g)
      if (scratch.groups[g].persistent == persistent &&
          (scratch.groups[g].type_bits & type_bits & in.device->device_local_type_bits) != 0)
        return g;
    scratch.groups.push_back({persistent, type_bits, 0, 0});
    return static_cast<uint32_t>(scratch.groups.size() - 1);
  }

  bool shares_nothing(const PlanResource& resource) const {
    return !in.alias || resource.declared == in.keep_alive;
  }

  void make_placements() {
    const auto last_pass = static_cast<uint32_t>(plan.passes.size()) - 1;
    for (uint32_t r = 0; r < plan.resources.size(); ++r) {
      PlanResource& resource = plan.resources[r];
      if (sizes.info[resource.declared.value].host_owned) continue;
      if (placements.history_aliases[r].target != invalid_index) continue;
      const Interval& life = schedule.lifetimes[resource.declared.value];
      const MemoryNeeds& needs = memory.needs[r];
      const bool persistent = histories.by_resource[r].frames > 0;
      const uint32_t index = group_of(persistent, needs.memory_type_bits);
      MemoryGroup& group = scratch.groups[index];
      group.type_bits &= needs.memory_type_bits;
      (resource.type == ResourceType::buffer ? group.buffers : group.images) +=
          resource.instance_count;
      resource.first_instance = static_cast<uint32_t>(plan.placements.size());
      const bool whole_frame = persistent || shares_nothing(resource);
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

  // Buffers and optimal images within one granule conflict. If a heap has both, every item gets
  // whole granules (VkPhysicalDeviceLimits::bufferImageGranularity).
  uint64_t granule_of(const MemoryGroup& group) const {
    const bool mixed = group.buffers != 0 && group.images != 0;
    return mixed ? std::max<uint64_t>(in.device->buffer_image_granularity, 1) : 1;
  }

  void place_group(uint32_t index) {
    const MemoryGroup& group = scratch.groups[index];
    const uint64_t granule = granule_of(group);
    Heap heap;
    heap.persistent = group.persistent;
    heap.memory_type_bits = group.type_bits;
    scratch.items.clear();
    scratch.item_placement.clear();
    for (uint32_t p = 0; p < plan.placements.size(); ++p) {
      Placement& placement = plan.placements[p];
      if (placement.heap != index) continue;
      placement.alignment = std::max({placement.alignment, granule, uint64_t{1}});
      heap.alignment = std::max(heap.alignment, placement.alignment);
      const uint64_t size = granule == 1 ? placement.size : align_up(placement.size, granule);
      scratch.items.push_back({size, placement.alignment, placement.first_use, placement.last_use});
      scratch.item_placement.push_back(p);
    }
    scratch.packer.pack(scratch.items, in.packing, scratch.packing);
    for (size_t i = 0; i < scratch.items.size(); ++i)
      plan.placements[scratch.item_placement[i]].offset = scratch.packing.offsets[i];
    heap.size = scratch.packing.size;
    heap.max_live_bytes = scratch.packing.lower_bound;
    (group.persistent ? plan.history_bytes : plan.transient_bytes) += heap.size;
    plan.heaps.push_back(heap);
  }

  void place_all() {
    scratch.groups.clear();
    plan.heaps.clear();
    plan.placements.clear();
    plan.transient_bytes = plan.history_bytes = 0;
    make_placements();
    for (uint32_t g = 0; g < scratch.groups.size(); ++g)
      place_group(g);
  }

  // After all other placements: one instance of each alias for each instance of its target. Of n
  // instances, frame f writes instance f mod n; the next instance has the oldest frame.
  void place_aliases() {
    for (uint32_t r = 0; r < plan.resources.size(); ++r) {
      const HistoryAlias& history_alias = placements.history_aliases[r];
      if (history_alias.target == invalid_index) continue;
      PlanResource& resource = plan.resources[r];
      const PlanResource& target = plan.resources[history_alias.target];
      const Interval& life = schedule.lifetimes[resource.declared.value];
      resource.first_instance = static_cast<uint32_t>(plan.placements.size());
      resource.instance_count = target.instance_count;
      for (uint32_t i = 0; i < resource.instance_count; ++i) {
        const uint32_t slot = (i + (history_alias.after_last_read ? 1 : 0)) % target.instance_count;
        const Placement there = plan.placements[target.first_instance + slot];
        Placement& placement = plan.placements.emplace_back();
        placement.resource = r;
        placement.heap = there.heap;
        placement.offset = there.offset + history_alias.offset;
        placement.size = memory.needs[r].size;
        placement.alignment = memory.needs[r].alignment;
        placement.first_use = life.first;
        placement.last_use = life.last;
      }
      report.record_reason(Reason::About::resource, resource.declared.value,
                           Reason::ReasonKind::aliases_history, target.declared.value,
                           history_alias.after_last_read ? 1 : 0);
    }
  }
};

} // namespace

const Placements& place_resources(const CompileInput& in, const Sizes& sizes,
                                  const Subresources& subresources, const QueueAssignment& queues,
                                  const ResourceMemory& memory, const Schedule& schedule,
                                  const Histories& histories, Report& report, Plan& plan,
                                  PlacementScratch& scratch) {
  Placements& placements = scratch.result;
  placements.history_aliases.assign(plan.resources.size(), {});
  Placer placer{in, sizes, memory, schedule, histories, report, plan, scratch};
  placer.place_all();
  if (!in.alias || queues.two()) return placements; // two queues give no common order of positions
  const AliasInput aliasing{in, subresources, memory, schedule, histories, plan, scratch.groups};
  if (!find_history_aliases(aliasing, placements.history_aliases)) return placements;
  const uint64_t bytes_without = plan.transient_bytes;
  placer.place_all();
  if (plan.transient_bytes < bytes_without) {
    placer.place_aliases();
  } else {
    placements.history_aliases.assign(plan.resources.size(), {});
    placer.place_all();
  }
  return placements;
}

} // namespace dermis
