// dermis explain: the plan with a reason for each decision, or what the code of a message means.

#include "framegraph/explain/plan_json.hpp"
#include "framegraph/explain/plan_text.hpp"
#include "framegraph/text/json_writer.hpp"
#include "integration/command/inspect/graph_input.hpp"
#include "integration/command/output.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace dermis::tools {
namespace {

const DiagnosticInfo* find_code(std::string_view code) {
  const auto all = all_diagnostic_infos();
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const DiagnosticInfo& one) { return one.code == code; });
  return found == all.end() ? nullptr : &*found;
}

std::string_view severity_word(Severity severity) {
  return severity == Severity::error ? "error" : severity == Severity::warning ? "warning" : "note";
}

std::string describe_code(const DiagnosticInfo& info, bool json) {
  if (json) {
    JsonWriter answer;
    answer.open_object().member("id", info.code).member("name", info.name);
    answer.member("severity", severity_word(info.severity)).member("hint", info.hint).close();
    return std::move(answer).finish();
  }
  return fmt::format("{} {} ({})\n{}\nMore: docs/diagnostics.md\n", info.code, info.name,
                     severity_word(info.severity), info.hint);
}

ExitCode deliver(const Session& session, const std::string& path, std::string_view text) {
  const std::string problem = deliver_text(path, text);
  return problem.empty() ? ExitCode::ok : fail(session, ExitCode::environment, problem);
}

} // namespace

ExitCode explain(const Session& session, const ExplainOptions& options) {
  if (const DiagnosticInfo* info = find_code(options.graph))
    return deliver(session, options.out, describe_code(*info, session.json));

  Diagnostics diagnostics;
  const std::optional<LoadedGraph> loaded = load_graph(options.graph, options.parts, diagnostics);
  if (!loaded) return fail_graph(session, options.graph, diagnostics);
  CompileChoices choices = read_choices(loaded->graph, options.settings, options.unbound);
  choices.two_queues = options.two_queues;
  if (!choices.problem.empty()) return fail(session, ExitCode::usage, choices.problem);
  const std::optional<CompiledPlan> compiled = compile_generic(*loaded, options.size, choices, diagnostics);
  if (!compiled) return fail_graph(session, options.graph, diagnostics);
  print_diagnostics(session, diagnostics);
  return deliver(
      session, options.out,
      session.json
          ? plan_json(loaded->graph, loaded->kinds, *compiled, {loaded->changes, diagnostics.files})
          : plan_text(loaded->graph, loaded->kinds, *compiled, {loaded->changes, diagnostics.files}));
}

} // namespace dermis::tools
