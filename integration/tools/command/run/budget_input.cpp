#include "integration/tools/command/run/budget_input.hpp"

#include "integration/examples/demo_engine/files.hpp"

#include <fmt/format.h>

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

} // namespace dermis::tools
