#include "integration/tools/command/run/choice_sets.hpp"

#include <fmt/format.h>

namespace dermis::tools {

std::optional<ChoiceConfigurations> choice_configurations(const CompileInput& input,
                                                          const std::vector<bool>& pinned,
                                                          const choice::ErrorModel& errors,
                                                          choice::CostEstimator& costs,
                                                          Diagnostics& diagnostics) {
  const auto combinations = choice::enumerate_combinations(input, diagnostics, pinned);
  if (!combinations) return std::nullopt;
  ChoiceConfigurations out;
  for (const uint32_t first : combinations->first) {
    CompileInput one = input;
    one.settings = combinations->settings[first];
    auto plan = compile(one, diagnostics);
    if (!plan) return std::nullopt;
    out.compiled.push_back(std::move(*plan));
  }
  for (const CompiledPlan& one : out.compiled)
    out.plans.push_back(&one.plan);
  out.all = choice::make_configurations(input, *combinations, out.plans, errors, costs);
  return out;
}

std::optional<ChoiceConfigurations>
choice_configurations(const LoadedGraph& loaded, const Size& size, Diagnostics& diagnostics) {
  const DeviceProfile device = generic_profile();
  const CompileChoices choices = read_choices(loaded.graph);
  choice::CostEstimator costs;
  choice::ErrorModel no_errors;
  no_errors.unscattered = {{1, 1}};
  return choice_configurations(compile_input(loaded, device, size, choices), {}, no_errors, costs,
                               diagnostics);
}

std::vector<std::vector<NamedValue>> choice_sets(const LoadedGraph& loaded, const Size& size,
                                                 Diagnostics& diagnostics) {
  std::vector<std::vector<NamedValue>> sets;
  const auto configurations = choice_configurations(loaded, size, diagnostics);
  if (!configurations) return sets;
  for (const choice::Configuration& configuration : configurations->all) {
    std::vector<NamedValue>& set = sets.emplace_back();
    for (size_t i = 0; i < loaded.graph.settings.size(); ++i) {
      const SettingDeclaration& setting = loaded.graph.settings[i];
      if (setting.by_budget)
        set.emplace_back(
            setting.name,
            fmt::format("\"{}\"",
                        setting.options[static_cast<size_t>(configuration.settings[i].integer)]));
    }
  }
  return sets;
}

} // namespace dermis::tools
