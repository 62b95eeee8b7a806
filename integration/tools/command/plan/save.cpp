// dermis plan save: writes the plan of a graph to a file.

#include "framegraph/text/json_writer.hpp"
#include "integration/tools/command/output.hpp"
#include "integration/tools/command/plan/input.hpp"

#include <fmt/format.h>

namespace dermis::tools {

ExitCode plan_save(const Session& session, const PlanSaveOptions& options) {
  Diagnostics diagnostics;
  std::string problem;
  const auto plan = load_plan({options.graph, options.inputs, options.size, options.settings,
                               options.unbound, options.two_queues},
                              diagnostics, problem);
  if (!problem.empty()) return fail(session, ExitCode::usage, problem);
  if (!plan) return fail_graph(session, options.graph, diagnostics);
  if (!plan->from_graph)
    return fail(session, ExitCode::usage, options.graph + ": is already a saved plan");
  print_beside_document(session, diagnostics);
  const std::string bytes = write_plan(plan->saved);
  if (session.json && options.out == "-")
    return fail(session, ExitCode::usage, "--json and --out - both write to standard output");
  if (const std::string error = deliver_text(options.out, bytes); !error.empty())
    return fail(session, ExitCode::environment, error);
  if (session.json) {
    JsonWriter answer;
    answer.open_object()
        .member("ok", true)
        .member("file", options.out)
        .member("bytes", bytes.size());
    answer.member("sha256", digest_text(sha256(bytes))).close();
    print(std::move(answer).finish());
  } else if (options.out != "-") {
    say(session, fmt::format("{}: {} passes, {} bytes\n", options.out,
                             plan->saved.plan.passes.size(), bytes.size()));
  }
  return ExitCode::ok;
}

} // namespace dermis::tools
