#pragma once
// Compares two plans by name: their inputs, passes and pass order, resources, memory, histories and
// barriers.

#include "framegraph/serialize/plan_file.hpp"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace dermis {

struct PlanTotals {
  uint64_t passes = 0, barriers = 0, batches = 0; // batches: pass boundaries that have barriers
  uint64_t transient_bytes = 0, history_bytes = 0;
};

struct PlanDifference {
  std::string name; // of a pass, resource or setting; unique within its section
  std::string a, b; // value on either side; "": absent
};

struct PlanDiffSection {
  // "compiled_from", "settings", "passes", "order", "resources", "heaps", "placements",
  // "histories", "barriers"
  std::string_view name;
  std::vector<PlanDifference> differences;
};

struct PlanDiff {
  bool same = false; // plans and names are equal byte for byte; their inputs may differ
  PlanTotals a, b;
  std::vector<PlanDiffSection> sections; // all sections, in the order above
};

PlanDiff diff_plans(const SavedPlan& a, const SavedPlan& b);

// Returns human-readable text: '-' only in a, '+' only in b, '~' in both. Sections without
// differences are omitted. `name_a` and `name_b` say where the plans come from.
std::string plan_diff_text(const PlanDiff& diff, std::string_view name_a, std::string_view name_b);
// Returns JSON for programs; docs/plans.md describes the layout.
std::string plan_diff_json(const PlanDiff& diff, std::string_view name_a, std::string_view name_b);

} // namespace dermis
