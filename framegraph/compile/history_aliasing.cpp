// The memory of a history that nobody needs for a while. Of a history that keeps N earlier frames in N + 1
// instances, the one that this frame writes holds nothing before that, and the one with the oldest frame
// nothing after its last read:
//
//   frame f      |--- lent ---| written: frame f ............................... |
//   frame f + N  | read as the oldest frame ......... last read |--- lent -------|   then lent on, and
//   written
//
// Transients that are alive only then may lie there instead of in a heap of their own. Which instance it is
// goes round from frame to frame, so a borrower has an instance in each of them and goes round with it.

#include "framegraph/compile/phases.hpp"

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

namespace dermis {
namespace {

// A plan; each loan looks at all transients and lenders once more.
constexpr uint32_t max_history_aliases = 64, max_alias_targets = 16;

struct AliasTarget {
  CompileContext& c;
  Plan& plan;
  std::vector<int64_t> alive = {};                       // by position: bytes of the transients of one heap
  std::vector<uint32_t> aliased_resources = {};          // plan resources with a loan
  std::vector<uint32_t> alias_targets = {};              // plan resources that lend, the largest first
  std::vector<std::pair<uint64_t, uint64_t>> taken = {}; // scratch: bytes that others have, by begin

  const Interval& life(uint32_t resource) const {
    return c.intervals[plan.resources[resource].declared.value];
  }
  const Placement& placement(uint32_t resource) const {
    return plan.placements[plan.resources[resource].first_instance];
  }

  bool is_aliased(uint32_t resource) const {
    const Lifetime& history = c.lifetimes[plan.resources[resource].declared.value];
    return history.deepest_read > 0 && c.info[plan.resources[resource].declared.value].parts == 1 &&
           plan.resources[resource].declared != c.input->keep_alive &&
           plan.resources[resource].instance_count == history.deepest_read + 1 &&
           history.renewal.first_touch != no_value;
  }

  bool may_alias(uint32_t resource) const {
    const PlanResource& one = plan.resources[resource];
    return one.first_instance != no_instance && !placement(resource).persistent &&
           one.declared != c.input->keep_alive && c.info[one.declared.value].parts == 1 &&
           c.history_aliases[resource].from == no_value;
  }

  // In the heap of the lender, in memory of the same type, where the lender has nothing itself.
  bool suits(uint32_t resource, uint32_t alias_target, bool after) const {
    const Placement &own = placement(resource), &there = placement(alias_target);
    const Renewal& renewal = c.lifetimes[plan.resources[alias_target].declared.value].renewal;
    const bool in_time =
        after ? life(resource).first > renewal.last_read : life(resource).last < renewal.first_touch;
    return in_time && plan.resources[resource].type == plan.resources[alias_target].type &&
           own.size <= there.size && own.alignment <= there.alignment &&
           (c.groups[there.heap].type_bits & ~c.needs[resource].memory_type_bits) == 0;
  }

  // The lowest place in what `lender` lends; false where there is none.
  bool find_offset(uint32_t resource, uint32_t alias_target, bool after, uint64_t& offset) {
    const Placement& own = placement(resource);
    taken.clear();
    for (const uint32_t other : aliased_resources) {
      const HistoryAlias& history_alias = c.history_aliases[other];
      if (history_alias.from == alias_target && history_alias.after == after &&
          life(other).first <= life(resource).last && life(resource).first <= life(other).last)
        taken.emplace_back(history_alias.offset, history_alias.offset + placement(other).size);
    }
    std::sort(taken.begin(), taken.end());
    offset = 0;
    for (const auto& [begin, end] : taken) {
      if (offset + own.size <= begin) break;
      offset = std::max(offset, (end + own.alignment - 1) / own.alignment * own.alignment);
    }
    return offset + own.size <= placement(alias_target).size;
  }

  bool alias(uint32_t resource) {
    for (const uint32_t alias_target : alias_targets)
      for (const bool after : {false, true}) {
        uint64_t offset = 0;
        if (!suits(resource, alias_target, after) || !find_offset(resource, alias_target, after, offset))
          continue;
        c.history_aliases[resource] = {alias_target, after, offset};
        aliased_resources.push_back(resource);
        return true;
      }
    return false;
  }

  // As long as something that is alive where most bytes are can lie elsewhere: the largest of it.
  void shrink_heap(uint32_t heap) {
    alive.assign(plan.passes.size() + 1, 0);
    std::vector<uint32_t> items;
    for (uint32_t r = 0; r < plan.resources.size(); ++r) {
      if (!may_alias(r) || placement(r).heap != heap) continue;
      items.push_back(r);
      alive[life(r).first] += static_cast<int64_t>(placement(r).size);
      alive[life(r).last + 1] -= static_cast<int64_t>(placement(r).size);
    }
    std::partial_sum(alive.begin(), alive.end(), alive.begin());
    std::stable_sort(items.begin(), items.end(),
                     [&](uint32_t a, uint32_t b) { return placement(a).size > placement(b).size; });
    for (bool again = true; again && aliased_resources.size() < max_history_aliases;) {
      const auto peak = static_cast<uint32_t>(std::max_element(alive.begin(), alive.end()) - alive.begin());
      const auto found = std::find_if(items.begin(), items.end(), [&](uint32_t r) {
        return c.history_aliases[r].from == no_value && life(r).first <= peak && peak <= life(r).last &&
               alias(r);
      });
      again = found != items.end();
      for (uint32_t p = again ? life(*found).first : 1; again && p <= life(*found).last; ++p)
        alive[p] -= static_cast<int64_t>(placement(*found).size);
    }
  }
};

} // namespace

bool find_history_aliases(CompileContext& c) {
  Plan& plan = c.out->plan;
  c.history_aliases.assign(plan.resources.size(), {});
  if (!c.input->alias || !c.queue.empty()) return false; // whose queues run past each other
  AliasTarget alias_target{c, plan};
  for (uint32_t r = 0; r < plan.resources.size(); ++r)
    if (alias_target.is_aliased(r)) alias_target.alias_targets.push_back(r);
  if (alias_target.alias_targets.empty()) return false;
  std::stable_sort(alias_target.alias_targets.begin(), alias_target.alias_targets.end(),
                   [&](uint32_t a, uint32_t b) {
                     return alias_target.placement(a).size > alias_target.placement(b).size;
                   });
  alias_target.alias_targets.resize(std::min<size_t>(alias_target.alias_targets.size(), max_alias_targets));
  for (uint32_t heap = 0; heap < plan.heaps.size(); ++heap)
    if (!plan.heaps[heap].persistent) alias_target.shrink_heap(heap);
  return !alias_target.aliased_resources.empty();
}

} // namespace dermis
