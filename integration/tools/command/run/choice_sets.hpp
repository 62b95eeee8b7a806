#pragma once
// Enumerates the configurations of a graph.

#include "integration/tools/command/graph_input.hpp"
#include "passes/choice/configurations.hpp"

#include <vector>

namespace dermis::tools {

// Returns one set of values per configuration (docs/choice.md), the defaults first; values are JSON
// text. Returns an empty list with errors in `diagnostics`.
std::vector<std::vector<NamedValue>> choice_sets(const LoadedGraph& loaded, const Size& size,
                                                 Diagnostics& diagnostics);

struct ChoiceConfigurations {
  std::vector<CompiledPlan> compiled;
  std::vector<const Plan*> plans; // by Configuration::plan
  std::vector<choice::Configuration> all;
};
// Compiles the plans of all configurations. Settings that `pinned` marks keep their value. Returns
// nullopt with errors in `diagnostics`.
std::optional<ChoiceConfigurations> choice_configurations(const CompileInput& input,
                                                          const std::vector<bool>& pinned,
                                                          const choice::ErrorModel& errors,
                                                          choice::CostEstimator& costs,
                                                          Diagnostics& diagnostics);

// Same, on the generic device, without a setting of the host and without tables.
std::optional<ChoiceConfigurations>
choice_configurations(const LoadedGraph& loaded, const Size& size, Diagnostics& diagnostics);

} // namespace dermis::tools
