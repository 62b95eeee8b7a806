// dermis graph: writes the graph with its plan for Graphviz, as JSON, or as an HTML page.

#include "framegraph/explain/plan_dot.hpp"
#include "framegraph/explain/plan_json.hpp"
#include "integration/tools/command/graph_input.hpp"
#include "integration/tools/command/inspect/view.hpp"
#include "integration/tools/command/output.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

namespace dermis::tools {
namespace {

ExitCode write_view(const Session& session, const GraphOptions& options, const LoadedGraph& loaded,
                    const CompileChoices& choices, Diagnostics& diagnostics) {
  const ViewAnswer view =
      make_view(loaded, {options.size, session.command, options.frame, choices}, diagnostics);
  if (!view.problem.empty()) return fail(session, ExitCode::environment, view.problem);
  if (view.page.empty())
    return fail_graph(session, view.bad_file.empty() ? options.graph : view.bad_file, diagnostics);
  print_beside_document(session, diagnostics);
  if (!view.warning.empty()) spdlog::warn("{}", for_terminal(view.warning));
  const std::string problem = deliver_page(options.html, view.page);
  if (!problem.empty()) return fail(session, ExitCode::environment, problem);
  if (options.html != "-")
    say(session, fmt::format("{}: {}; open the page in a browser\n", options.html,
                             format_bytes(view.page.size())));
  return ExitCode::ok;
}

} // namespace

ExitCode graph(const Session& session, const GraphOptions& options) {
  Diagnostics diagnostics;
  const std::optional<LoadedGraph> loaded = load_graph(options.graph, options.inputs, diagnostics);
  if (!loaded) return fail_graph(session, options.graph, diagnostics);
  CompileChoices choices = read_choices(loaded->graph, options.settings, options.unbound);
  choices.two_queues = options.two_queues;
  if (!choices.problem.empty()) return fail(session, ExitCode::usage, choices.problem);
  if (!options.html.empty()) return write_view(session, options, *loaded, choices, diagnostics);
  const std::optional<CompiledPlan> compiled =
      compile_generic(*loaded, options.size, choices, diagnostics);
  if (!compiled) return fail_graph(session, options.graph, diagnostics);
  print_beside_document(session, diagnostics);
  const std::string problem = deliver_text(
      options.out, session.json ? plan_json(loaded->graph, loaded->pass_types, *compiled,
                                            {loaded->changes, diagnostics.files})
                                : plan_dot(loaded->graph, loaded->pass_types, *compiled));
  return problem.empty() ? ExitCode::ok : fail(session, ExitCode::environment, problem);
}

} // namespace dermis::tools
