// Aliases transients into idle history memory. A history that keeps N earlier frames in N + 1
// instances has two idle times: the instance that this frame writes is idle before this frame's
// contents are first accessed, and the instance of the oldest frame is idle after its last read:
//
//   frame f      |--- idle ---| this frame's contents ............................ |
//   frame f + N  | read as the oldest frame ......... last read |------ idle ------|
//
// Transients whose lifetime lies within such a time may use that memory instead of a heap of their
// own. The history's instances rotate from frame to frame, so an alias has one instance in each and
// rotates with them.

#include "framegraph/compile/placements.hpp"
#include "framegraph/model/align_up.hpp"

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

namespace dermis {
namespace {

// Limits for one plan: each alias costs one more search over all transients and targets.
constexpr uint32_t max_history_aliases = 64, max_alias_targets = 16;

struct HistoryAliaser {
  const AliasInput& input;
  const Plan& plan;
  std::vector<HistoryAlias>& aliases;           // by plan resource
  std::vector<int64_t> live_bytes = {};         // by position: transients of one heap
  std::vector<uint32_t> aliased_resources = {}; // plan resources with an alias
  std::vector<uint32_t> targets = {}; // plan resources with idle memory, the largest first
  std::vector<std::pair<uint64_t, uint64_t>> taken =
      {}; // byte ranges that other aliases use, by begin

  const Interval& life(uint32_t resource) const {
    return input.schedule.lifetimes[plan.resources[resource].declared.value];
  }
  const Placement& placement(uint32_t resource) const {
    return plan.placements[plan.resources[resource].first_instance];
  }

  const HistoryLifetime& history(uint32_t resource) const {
    return input.histories.by_resource[resource];
  }

  bool is_target(uint32_t resource) const {
    const PlanResource& candidate = plan.resources[resource];
    return history(resource).frames > 0 && !input.subresources.divided(candidate.declared) &&
           candidate.declared != input.in.keep_alive &&
           candidate.instance_count == history(resource).frames + 1 &&
           history(resource).first_access != invalid_index;
  }

  bool may_alias(uint32_t resource) const {
    const PlanResource& candidate = plan.resources[resource];
    return candidate.first_instance != no_instance && !placement(resource).persistent &&
           candidate.declared != input.in.keep_alive &&
           !input.subresources.divided(candidate.declared) &&
           aliases[resource].target == invalid_index;
  }

  // Returns whether the transient fits into the target in an idle time and allows the memory types
  // of its heap.
  bool can_alias(uint32_t resource, uint32_t target, bool after_last_read) const {
    const Placement &own = placement(resource), &there = placement(target);
    const bool in_time = after_last_read ? life(resource).first > history(target).last_read
                                         : life(resource).last < history(target).first_access;
    return in_time && plan.resources[resource].type == plan.resources[target].type &&
           own.size <= there.size && own.alignment <= there.alignment &&
           (input.groups[there.heap].type_bits & ~input.memory.needs[resource].memory_type_bits) ==
               0;
  }

  // Finds the lowest free offset in the target; returns false if there is none.
  bool find_offset(uint32_t resource, uint32_t target, bool after_last_read, uint64_t& offset) {
    const Placement& own = placement(resource);
    taken.clear();
    for (const uint32_t other : aliased_resources) {
      const HistoryAlias& history_alias = aliases[other];
      if (history_alias.target == target && history_alias.after_last_read == after_last_read &&
          life(other).first <= life(resource).last && life(resource).first <= life(other).last)
        taken.emplace_back(history_alias.offset, history_alias.offset + placement(other).size);
    }
    std::sort(taken.begin(), taken.end());
    offset = 0;
    for (const auto& [begin, end] : taken) {
      if (offset + own.size <= begin) break;
      offset = std::max(offset, align_up(end, own.alignment));
    }
    return offset + own.size <= placement(target).size;
  }

  bool alias(uint32_t resource) {
    for (const uint32_t target : targets)
      for (const bool after_last_read : {false, true}) {
        uint64_t offset = 0;
        if (!can_alias(resource, target, after_last_read) ||
            !find_offset(resource, target, after_last_read, offset))
          continue;
        aliases[resource] = {target, after_last_read, offset};
        aliased_resources.push_back(resource);
        return true;
      }
    return false;
  }

  // Repeats: aliases the largest transient that is live where the heap has the most live bytes.
  void shrink_heap(uint32_t heap) {
    live_bytes.assign(plan.passes.size() + 1, 0);
    std::vector<uint32_t> items;
    for (uint32_t r = 0; r < plan.resources.size(); ++r) {
      if (!may_alias(r) || placement(r).heap != heap) continue;
      items.push_back(r);
      live_bytes[life(r).first] += static_cast<int64_t>(placement(r).size);
      live_bytes[life(r).last + 1] -= static_cast<int64_t>(placement(r).size);
    }
    std::partial_sum(live_bytes.begin(), live_bytes.end(), live_bytes.begin());
    std::stable_sort(items.begin(), items.end(),
                     [&](uint32_t a, uint32_t b) { return placement(a).size > placement(b).size; });
    for (bool again = true; again && aliased_resources.size() < max_history_aliases;) {
      const auto peak = static_cast<uint32_t>(
          std::max_element(live_bytes.begin(), live_bytes.end()) - live_bytes.begin());
      const auto found = std::find_if(items.begin(), items.end(), [&](uint32_t r) {
        return aliases[r].target == invalid_index && life(r).first <= peak &&
               peak <= life(r).last && alias(r);
      });
      again = found != items.end();
      for (uint32_t p = again ? life(*found).first : 1; again && p <= life(*found).last; ++p)
        live_bytes[p] -= static_cast<int64_t>(placement(*found).size);
    }
  }
};

} // namespace

bool find_history_aliases(const AliasInput& input, std::vector<HistoryAlias>& aliases) {
  const Plan& plan = input.plan;
  HistoryAliaser aliaser{input, plan, aliases};
  std::vector<uint32_t>& targets = aliaser.targets;
  for (uint32_t r = 0; r < plan.resources.size(); ++r)
    if (aliaser.is_target(r)) targets.push_back(r);
  if (targets.empty()) return false;
  std::stable_sort(targets.begin(), targets.end(), [&](uint32_t a, uint32_t b) {
    return aliaser.placement(a).size > aliaser.placement(b).size;
  });
  targets.resize(std::min<size_t>(targets.size(), max_alias_targets));
  for (uint32_t heap = 0; heap < plan.heaps.size(); ++heap)
    if (!plan.heaps[heap].persistent) aliaser.shrink_heap(heap);
  return !aliaser.aliased_resources.empty();
}

} // namespace dermis
