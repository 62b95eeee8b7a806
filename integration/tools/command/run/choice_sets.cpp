#include "integration/tools/command/run/choice_sets.hpp"

#include "passes/choice/configurations.hpp"

#include <fmt/format.h>

namespace dermis::tools {

std::vector<std::vector<NamedValue>> choice_sets(const LoadedGraph& loaded, const Size& size,
                                                 Diagnostics& diagnostics) {
  const DeviceProfile device = generic_profile();
  const CompileChoices choices = read_choices(loaded.graph);
  const CompileInput input = compile_input(loaded, device, size, choices);
  std::vector<std::vector<NamedValue>> sets;
  const auto combinations = choice::enumerate_combinations(input, diagnostics);
  if (!combinations) return sets;
  std::vector<CompiledPlan> compiled;
  for (const uint32_t first : combinations->first) {
    CompileInput one = input;
    one.settings = combinations->settings[first];
    auto plan = compile(one, diagnostics);
    if (!plan) return sets;
    compiled.push_back(std::move(*plan));
  }
  std::vector<const Plan*> plans;
  for (const CompiledPlan& one : compiled)
    plans.push_back(&one.plan);
  choice::CostEstimator costs;
  for (const choice::Configuration& configuration :
       choice::make_configurations(input, *combinations, plans, {"", {{1, 1}}, {}}, costs)) {
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
