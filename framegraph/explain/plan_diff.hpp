#pragma once
// What differs between two plans, by the names that people know: what they were compiled from, passes and
// their order, resources, memory, histories, barriers.

#include "framegraph/serial/plan_file.hpp"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace dermis {

struct PlanTotals {
  uint64_t passes = 0, barriers = 0, batches = 0; // batches: boundaries that have barriers
  uint64_t transient_bytes = 0, history_bytes = 0;
};

struct PlanDifference {
  std::string name; // of a pass, resource, setting ...; within its section there is one of each
  std::string a, b; // what it is on either side; "": not there
};

struct PlanDiffSection {
  std::string_view name; // "compiled_from", "settings", "passes", "order", "resources", "placements",
                         // "histories", "barriers"
  std::vector<PlanDifference> differences;
};

struct PlanDiff {
  bool same = false; // byte for byte, also by their names; what they were compiled from may differ
  PlanTotals a, b;
  std::vector<PlanDiffSection> sections; // all of them, in that order
};

PlanDiff diff_plans(const SavedPlan& a, const SavedPlan& b);

// For people: '-' only in a, '+' only in b, '~' in both; sections without differences are left out. `name_a`
// and `name_b` say where the plans come from.
std::string plan_diff_text(const PlanDiff& diff, std::string_view name_a, std::string_view name_b);
// For programs; the layout is in docs/plans.md.
std::string plan_diff_json(const PlanDiff& diff, std::string_view name_a, std::string_view name_b);

} // namespace dermis
