// What a pass does to each object, and the accesses that the plan lists for it.

#include "framegraph/compile/barriers/synchronizer.hpp"

#include <algorithm>
#include <span>

namespace dermis {

void Synchronizer::collect(uint32_t first_use, uint32_t end) {
  if (c.touch_of_use.size() < end - first_use) {
    c.touch_of_use.resize(end - first_use);
    c.touches.resize(end - first_use);
  }
  touch_count = 0;
  PassTouch* const touches = c.touches.data();
  uint32_t* touch_number = c.touch_of_use.data();
  for (uint32_t u = first_use; u < end; ++u, ++touch_number) {
    const Use& use = c.uses[u];
    *touch_number = no_value;
    if (use.bind_error != Use::BindError::none) continue;
    const uint32_t resource = c.plan_resource[use.resource.value];
    const ResourceSyncInfo& of = info(resource);
    const uint32_t part = of.parts == 1 ? 0 : c.part_index(use);
    const uint32_t object = object_of(of, use.frames_back, part);
    uint32_t& number = c.touch_number[object];
    if (number < touches_before) { // by an earlier pass
      number = touches_before + touch_count;
      touches[touch_count++] = {object, resource, use.frames_back, 0, false, part, Layout::undefined};
    }
    *touch_number = number - touches_before;
    PassTouch& touch = touches[*touch_number];
    touch.usages = static_cast<uint16_t>(touch.usages | 1u << static_cast<uint32_t>(use.usage));
    touch.certain |= use.when == ReadWhen::always;
    if (of.image) touch.layout = sets[touch.usages].image_layout;
  }
  touches_before += touch_count;
  if (c.graph->parts) unify_layouts(first_use, end);
}

void Synchronizer::unify_layouts(uint32_t first_use, uint32_t end) {
  for (bool again = true; again;) {
    again = false;
    uint32_t before = no_value; // touch of the use before
    for (uint32_t u = first_use; u < end; ++u) {
      const uint32_t touch = c.touch_of_use[u - first_use];
      if (touch != no_value && before != no_value && c.uses[u].binding == c.uses[u - 1].binding &&
          c.touches[touch].layout != c.touches[before].layout) {
        c.touches[touch].layout = c.touches[before].layout = Layout::general;
        again = true;
      }
      before = touch;
    }
  }
}

// Whether the pass writes the resource, in this frame or over an earlier one.
bool Synchronizer::writes_too(const Use& read, uint32_t first_use, uint32_t end) const {
  return std::any_of(c.uses.begin() + first_use, c.uses.begin() + end, [&](const Use& other) {
    return other.writes && other.resource == read.resource && other.bind_error == Use::BindError::none;
  });
}

void Synchronizer::add_accesses(PlanPass& pass, uint32_t first_use, uint32_t end) {
  const std::span<const Port> ports = c.type(pass.declared).ports;
  pass.first_access = static_cast<uint32_t>(plan.accesses.size());
  for (uint32_t u = first_use; u < end; ++u) {
    const uint32_t touched = c.touch_of_use[u - first_use];
    if (touched == no_value) continue;
    const PassTouch& touch = c.touches[touched];
    const Use& use = c.uses[u];
    const UsageSet& usage = sets[size_t{1} << static_cast<uint32_t>(use.usage)];
    const SubresourceRange range = range_of(info(touch.resource), touch.resource, touch.part);
    if (c.graph->parts && u > first_use && use.binding == c.uses[u - 1].binding) { // a further part
      SubresourceRange& seen = plan.accesses.back().range;
      seen.mips = static_cast<uint16_t>(std::max(seen.first_mip + seen.mips, range.first_mip + range.mips) -
                                        seen.first_mip);
      seen.layers = static_cast<uint16_t>(
          std::max(seen.first_layer + seen.layers, range.first_layer + range.layers) - seen.first_layer);
      continue;
    }
    const Use* history = c.history_of(use);
    const bool alone = history && history->bind_error != Use::BindError::none; // nothing to stand in for
    plan.accesses.push_back({use.port, touch.resource, use.frames_back, range, usage.stages, usage.access,
                             touch.layout,
                             ports[use.port].own_texels && !use.writes && writes_too(use, first_use, end),
                             alone ? ReadWhen::always : use.when});
  }
  pass.access_count = static_cast<uint32_t>(plan.accesses.size()) - pass.first_access;
}

} // namespace dermis
