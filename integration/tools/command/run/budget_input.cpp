#include "integration/tools/command/run/budget_input.hpp"

#include "integration/examples/demo_engine/files.hpp"
#include "passes/choice/configurations.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace dermis::tools {

demo::Result<demo::NamedText> read_named(const std::string& path) {
  if (path.empty()) return demo::NamedText{};
  auto text = demo::read_text_file(path);
  if (!text) return text.error();
  if (text->empty()) return demo::Error{demo::ErrorKind::input, fmt::format("'{}' is empty", path)};
  return demo::NamedText{path, text.take()};
}

demo::Result<demo::Budget> read_budget(const BudgetArguments& arguments) {
  auto calibration = read_named(arguments.calibration);
  if (!calibration) return calibration.error();
  auto errors = read_named(arguments.errors);
  if (!errors) return errors.error();
  return demo::Budget{arguments.ms,       arguments.percentile,
                      arguments.trials,   arguments.deterministic,
                      calibration.take(), errors.take()};
}

std::string unused_budget(const BudgetArguments& arguments, const LoadedGraph& loaded,
                          const std::string& file) {
  const Graph& graph = loaded.graph;
  const bool used = arguments.ms == 0 ||
                    std::ranges::any_of(graph.settings, &SettingDeclaration::by_budget) ||
                    std::ranges::any_of(graph.passes, [&](const PassDeclaration& pass) {
                      return choice::runs_by_budget(loaded.pass_types[pass.type]);
                    });
  return used ? ""
              : fmt::format("--budget changes nothing in '{}': it has no setting with \"by\": "
                            "\"budget\" and no pass over tiles that the budget selects; "
                            "configs/graphs/skin.json has both",
                            file);
}

} // namespace dermis::tools
