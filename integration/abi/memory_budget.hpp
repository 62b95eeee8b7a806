#pragma once
// Selects the configurations whose plans fit into the host's memory budget, before anything is
// allocated for them.

#include "framegraph/compile/shared_heaps.hpp"
#include "passes/choice/configurations.hpp"

#include <optional>
#include <vector>

namespace dermis::abi {

struct MemoryBudget {
  uint64_t bytes = 0; // of one view: transients and histories
  HistoryMemory histories = HistoryMemory::shared;
};

// A plan of the choices by budget, and the plan that replaces it in frames with empty bounds.
struct PlanChoice {
  CompiledPlan own;
  std::optional<CompiledPlan> without_bounds;
};

// Removes plans and their configurations until the memory of one view is within the budget: the
// plans with the least expected error stay, at least one. The first
// configuration stays first, if its plan fits; otherwise the most accurate one takes its place.
// Reports what is removed, and a budget that no plan fits.
void keep_within_memory(const Graph& graph, const choice::ErrorModel& errors,
                        const MemoryBudget& budget, std::vector<PlanChoice>& plans,
                        std::vector<choice::Configuration>& configurations,
                        Diagnostics& diagnostics);

} // namespace dermis::abi
