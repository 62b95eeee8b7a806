#include "passes/choice/missing_rows.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <set>

namespace dermis::choice {
namespace {

using TypeNames = std::set<std::string_view>;

// Returns the pass types of the plan that scatter light.
TypeNames scattering_types(const PassTypeRegistry& pass_types, const Plan& plan, bool samples) {
  TypeNames names;
  for (const PlanPass& pass : plan.passes) {
    const PassType& type = pass_types[pass.type];
    const bool scatters =
        find_port(type, "scattered", PortSide::write) >= 0 && !copies_all_tiles(type);
    if (scatters && runs_by_budget(type) == samples) names.insert(type.name);
  }
  return names;
}

// Returns the pass types of which the error table needs a row that it lacks. Empty: none.
TypeNames types_without_row(const PassTypeRegistry& pass_types, const Plan& plan,
                            const Configuration& configuration) {
  const bool samples_have_row = configuration.technique != configuration.without_samples;
  if (configuration.takes_samples && !samples_have_row)
    return scattering_types(pass_types, plan, true);
  if (configuration.technique >= 0) return {};
  return scattering_types(pass_types, plan, false);
}

// Returns where the graph leaves a choice to the budget; else its first pass.
SourceLocation location_of_choice(const Graph& graph) {
  const auto choice = std::find_if(graph.settings.begin(), graph.settings.end(),
                                   [](const SettingDeclaration& one) { return one.by_budget; });
  if (choice != graph.settings.end()) return choice->where;
  return graph.passes.empty() ? SourceLocation{} : graph.passes.front().where;
}

std::string list_names(const std::vector<std::string_view>& names) {
  constexpr size_t max_names = 3;
  std::string text = fmt::format(
      "'{}'", fmt::join(names.begin(), names.begin() + std::min(names.size(), max_names), "', '"));
  if (names.size() > max_names) text += fmt::format(" and {} more", names.size() - max_names);
  return text;
}

} // namespace

void report_all_missing_rows(const Graph& graph, const PassTypeRegistry& pass_types,
                             std::span<const Plan* const> plans, const ErrorModel& errors,
                             const CostEstimator& costs,
                             std::span<const Configuration> configurations,
                             Diagnostics& diagnostics) {
  const SourceLocation where = location_of_choice(graph);
  std::map<TypeNames, std::vector<std::string_view>> without_row; // names of configurations
  TypeNames without_cost;
  std::vector<std::string_view> run_without_cost; // names of configurations
  for (const Configuration& configuration : configurations) {
    const Plan& plan = *plans[configuration.plan];
    const TypeNames types = types_without_row(pass_types, plan, configuration);
    if (!types.empty()) without_row[types].push_back(configuration.name);
    for (size_t p = 0; p < plan.passes.size(); ++p) {
      const PassLoad& load = configuration.passes[p];
      if (!load.launches || costs.has_calibration(load.cost)) continue;
      without_cost.insert(pass_types[plan.passes[p].type].name);
      if (run_without_cost.empty() || run_without_cost.back() != configuration.name)
        run_without_cost.push_back(configuration.name);
    }
  }
  for (const auto& [types, names] : without_row)
    diagnostics.add(
        DiagnosticId::error_row_missing, where,
        fmt::format("the error table '{}' has no technique for the pass types '{}' of {}; the "
                    "choice uses the error of unscattered light instead",
                    errors.scenes, fmt::join(types, "', '"), list_names(names)));
  if (!without_cost.empty())
    diagnostics.add(
        DiagnosticId::cost_missing, where,
        fmt::format("the calibration has no cost of the pass types '{}', which {} runs; "
                    "until they are timed, each counts like the most expensive pass",
                    fmt::join(without_cost, "', '"), list_names(run_without_cost)));
}

void report_missing_rows(const Graph& graph, const PassTypeRegistry& pass_types,
                         std::span<const Plan* const> plans, const ErrorModel& errors,
                         const CostEstimator& costs, std::span<const Configuration> configurations,
                         Diagnostics& diagnostics) {
  const bool samples = std::any_of(configurations.begin(), configurations.end(),
                                   [](const Configuration& one) { return one.takes_samples; });
  if (configurations.size() > 1 || samples)
    report_all_missing_rows(graph, pass_types, plans, errors, costs, configurations, diagnostics);
}

} // namespace dermis::choice
