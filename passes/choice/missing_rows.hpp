#pragma once
// Reports configurations that a budget cannot judge: without a row in the error table, or with
// passes that the calibration does not know.

#include "passes/choice/configurations.hpp"

#include <span>

namespace dermis::choice {

// Adds a warning for each technique without a row and for each pass type without a cost, at the
// first choice of the graph. `plans` is indexed by Configuration::plan. Reports nothing about
// graphs on which a budget has no effect: with one configuration, which takes no samples by tile.
void report_missing_rows(const Graph& graph, const PassTypeRegistry& pass_types,
                         std::span<const Plan* const> plans, const ErrorModel& errors,
                         const CostEstimator& costs, std::span<const Configuration> configurations,
                         Diagnostics& diagnostics);
// The same for graphs with any number of configurations.
void report_all_missing_rows(const Graph& graph, const PassTypeRegistry& pass_types,
                             std::span<const Plan* const> plans, const ErrorModel& errors,
                             const CostEstimator& costs,
                             std::span<const Configuration> configurations,
                             Diagnostics& diagnostics);

} // namespace dermis::choice
