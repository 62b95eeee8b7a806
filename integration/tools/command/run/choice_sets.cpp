#include "integration/tools/command/run/choice_sets.hpp"

#include "passes/choice/configurations.hpp"

#include <fmt/format.h>

namespace dermis::tools {

std::vector<std::vector<NamedValue>> choice_sets(const LoadedGraph& loaded, const Size& size,
                                                 Diagnostics& diagnostics) {
  const DeviceProfile device = generic_profile();
  const CompileChoices choices = read_choices(loaded.graph);
  choice::CostModel costs;
  const auto made = choice::make_outcomes(
      compile_input(loaded, device, size, choices), {"", {{1, 1}}, {}}, costs,
      [](const CompileInput& one, Diagnostics& reported) { return compile(one, reported); }, diagnostics);
  std::vector<std::vector<NamedValue>> sets;
  if (!made) return sets;
  for (const choice::Outcome& outcome : made->outcomes) {
    std::vector<NamedValue>& set = sets.emplace_back();
    for (size_t i = 0; i < loaded.graph.settings.size(); ++i) {
      const SettingDeclaration& setting = loaded.graph.settings[i];
      if (setting.by_budget)
        set.emplace_back(
            setting.name,
            fmt::format("\"{}\"", setting.options[static_cast<size_t>(outcome.settings[i].integer)]));
    }
  }
  return sets;
}

} // namespace dermis::tools
