// Merges the accesses of a pass to each object, and lists them in the plan.

#include "framegraph/compile/barrier_walk.hpp"

#include <algorithm>
#include <span>

namespace dermis {

void BarrierWalk::gather_accesses(std::span<const Use> uses) {
  if (accesses.of_use.size() < uses.size()) {
    accesses.of_use.resize(uses.size());
    accesses.list.resize(uses.size());
  }
  uint32_t count = 0;
  PassAccess* const list = accesses.list.data();
  uint32_t* access_number = accesses.of_use.data();
  for (const Use& use : uses) {
    uint32_t& of_use = *access_number++;
    of_use = invalid_index;
    if (use.bind_error != Use::BindError::none) continue;
    const uint32_t resource = in.memory.plan_index[use.resource.value];
    const ResourceSyncInfo& of = info(resource);
    const uint32_t range = of.ranges == 1 ? 0 : in.subresources.index_of(use);
    const uint32_t object = of.object(use.frames_back, range);
    uint32_t& last = accesses.last_number[object];
    if (last < accesses.first_number) { // the last access was by an earlier pass
      last = accesses.first_number + count;
      list[count++] = {object, resource, use.frames_back,   0,
                       false,  range,    Layout::undefined, false};
    }
    of_use = last - accesses.first_number;
    PassAccess& access = list[of_use];
    access.usages = static_cast<uint16_t>(access.usages | 1u << static_cast<uint32_t>(use.usage));
    access.always |= use.when == ReadWhen::always;
    access.internally_ordered |= in.active.type(use.pass).ports[use.port].internally_ordered;
    if (of.image) access.layout = sets[access.usages].image_layout;
  }
  accesses.count = count;
  accesses.first_number += count;
  if (in.subresources.any()) unify_layouts(uses);
}

void BarrierWalk::unify_layouts(std::span<const Use> uses) {
  for (bool again = true; again;) {
    again = false;
    uint32_t before = invalid_index; // access of the use before
    for (size_t u = 0; u < uses.size(); ++u) {
      const uint32_t access = accesses.of_use[u];
      if (access != invalid_index && before != invalid_index &&
          uses[u].binding == uses[u - 1].binding &&
          accesses.list[access].layout != accesses.list[before].layout) {
        accesses.list[access].layout = accesses.list[before].layout = Layout::general;
        again = true;
      }
      before = access;
    }
  }
}

namespace {

// Returns whether the pass writes the resource that `read` reads, in this frame or over an earlier
// one.
bool writes_too(const Use& read, std::span<const Use> uses) {
  return std::any_of(uses.begin(), uses.end(), [&](const Use& other) {
    return other.writes && other.resource == read.resource &&
           other.bind_error == Use::BindError::none;
  });
}

// Returns the reads of what the pass itself writes through the port.
Access own_reads(const Port& port) {
  return port.internally_ordered ? access::shader_storage_read : access::none;
}

// Extends `range` to the smallest range that contains `other`, too.
void extend(SubresourceRange& range, const SubresourceRange& other) {
  const auto end = [](uint32_t first, uint32_t count, uint32_t other_first, uint32_t others) {
    return std::max(first + count, other_first + others);
  };
  range.mips = static_cast<uint16_t>(end(range.first_mip, range.mips, other.first_mip, other.mips) -
                                     range.first_mip);
  range.layers = static_cast<uint16_t>(
      end(range.first_layer, range.layers, other.first_layer, other.layers) - range.first_layer);
}

} // namespace

void BarrierWalk::add_accesses(PlanPass& pass, std::span<const Use> uses) {
  const std::span<const Port> ports = in.active.type(pass.declared).ports;
  pass.first_access = static_cast<uint32_t>(plan.accesses.size());
  for (size_t u = 0; u < uses.size(); ++u) {
    if (accesses.of_use[u] == invalid_index) continue;
    const PassAccess& access = accesses.list[accesses.of_use[u]];
    const Use& use = uses[u];
    const UsageSet& usage = sets[size_t{1} << static_cast<uint32_t>(use.usage)];
    const SubresourceRange range = range_of(access.resource, access.range);
    if (in.subresources.any() && u > 0 && use.binding == uses[u - 1].binding) { // a further range
      extend(plan.accesses.back().range, range);
      continue;
    }
    const bool own_texels = ports[use.port].own_texels && !use.writes && writes_too(use, uses);
    // A substitute is read in every frame if its history has no version.
    const Use* history = history_of(use);
    const bool always = history && history->bind_error != Use::BindError::none;
    plan.accesses.push_back({use.port, access.resource, use.frames_back, range, usage.stages,
                             usage.access | own_reads(ports[use.port]), access.layout, own_texels,
                             ports[use.port].internally_ordered,
                             always ? ReadWhen::always : use.when});
  }
  pass.access_count = static_cast<uint32_t>(plan.accesses.size()) - pass.first_access;
}

} // namespace dermis
