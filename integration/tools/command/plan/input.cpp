#include "integration/tools/command/plan/input.hpp"

#include "framegraph/text/limits.hpp"
#include "integration/tools/files/bytes.hpp"

#include <fmt/format.h>

#include <fstream>

namespace dermis::tools {
namespace {

std::string name_of(const PlanSource& source) {
  std::string name = fmt::format("{}, {}x{}", source.file, source.size.width, source.size.height);
  for (const std::string& overlay : source.inputs.overlays)
    name += fmt::format(", overlay {}", overlay);
  for (const auto& [setting, value] : source.settings)
    name += fmt::format(", {}={}", setting, value);
  for (const std::string& slot : source.unbound)
    name += fmt::format(", without {}", slot);
  return name;
}

} // namespace

bool holds_plan(const std::string& path) {
  std::error_code ignored;
  if (path == "-" || !std::filesystem::is_regular_file(path, ignored)) return false;
  char first[16] = {};
  std::ifstream stream(path, std::ios::binary);
  stream.read(first, sizeof first);
  return is_plan_file({first, static_cast<size_t>(stream.gcount())});
}

std::optional<std::string> read_plan_bytes(const std::string& path, Diagnostics& diagnostics) {
  std::string error;
  const auto bytes = read_bytes(path, limits::file_bytes, error);
  if (bytes) return std::string(bytes->begin(), bytes->end());
  diagnostics.add(DiagnosticId::file_unreadable, {}, error);
  return std::nullopt;
}

std::optional<NamedPlan> load_plan(const PlanSource& source, Diagnostics& diagnostics,
                                   std::string& problem) {
  if (holds_plan(source.file)) {
    const auto bytes = read_plan_bytes(source.file, diagnostics);
    auto saved = bytes ? read_plan(source.file, *bytes, diagnostics) : std::nullopt;
    if (!saved) return std::nullopt;
    return NamedPlan{source.file, false, std::move(*saved)};
  }
  const std::optional<LoadedGraph> loaded = load_graph(source.file, source.inputs, diagnostics);
  if (!loaded) return std::nullopt;
  CompileChoices choices = read_choices(loaded->graph, source.settings, source.unbound);
  choices.two_queues = source.two_queues;
  problem = choices.problem;
  if (!problem.empty()) return std::nullopt;
  const DeviceProfile device = generic_profile();
  const CompileInput input = compile_input(*loaded, device, source.size, choices);
  const std::optional<CompiledPlan> compiled = compile_loaded(*loaded, input, diagnostics);
  if (!compiled) return std::nullopt;
  return NamedPlan{name_of(source), true, saved_plan(input, compiled->plan)};
}

} // namespace dermis::tools
