// dermis calibrate: measures the cost of a graph's passes on this device and writes a file for
// budgets.

#include "framegraph/text/json_writer.hpp"
#include "integration/tools/command/interrupt.hpp"
#include "integration/tools/command/output.hpp"
#include "integration/tools/command/run/budget_input.hpp"
#include "integration/tools/command/run/choice_sets.hpp"
#include "integration/tools/command/run/device_costs.hpp"
#include "integration/tools/command/run/host_passes.hpp"

#include <fmt/format.h>

namespace dermis::tools {

ExitCode calibrate(const Session& session, const CalibrateOptions& options) {
  Diagnostics diagnostics;
  const std::optional<LoadedGraph> loaded = load_graph(options.graph, options.inputs, diagnostics);
  if (!loaded) return fail_graph(session, options.graph, diagnostics);
  const auto all = choice_sets(*loaded, options.size, diagnostics);
  if (all.empty()) return fail_graph(session, options.graph, diagnostics);
  OutputFolder folder;
  if (const std::string problem = folder.open_for(options.out); !problem.empty())
    return fail(session, ExitCode::environment, problem);
  HostPasses host_passes(loaded->host_pass_types);
  CostsRequest request;
  request.hooks = host_passes.hooks();
  request.graph = options.graph;
  request.graph_text = loaded->text;
  request.scene = options.scene;
  request.roots = options.inputs.roots;
  request.size = options.size;
  request.frames = options.frames;
  request.sets = all;
  auto calibration = read_named(options.calibration);
  if (!calibration) return fail(session, calibration.error());
  request.calibration = calibration.take();
  request.overlays = loaded->overlays;
  request.include = for_engine(open_included(options.graph, options.inputs.roots));
  Progress progress(progress_style(session.quiet, session.json), "calibrate", "run",
                    count_cost_runs(request));
  uint32_t done = 0;
  const auto costs = measure_costs(request, [&] { progress.update(++done); });
  if (interrupted()) return fail(session, ExitCode::interrupted, "stopped");
  if (!costs) return fail(session, costs.error());
  if (const std::string problem = deliver_text(options.out, costs->calibration); !problem.empty())
    return fail(session, ExitCode::environment, problem);
  say(session, options.out == "-" ? ""
                                  : fmt::format("{} holds the costs of {} on {}\n", options.out,
                                                diagnostics.files.front().name, costs->device));
  if (session.json && options.out != "-") {
    JsonWriter answer;
    answer.open_object()
        .member("ok", true)
        .member("out", options.out)
        .member("device", costs->device)
        .close();
    print(std::move(answer).finish());
  }
  return ExitCode::ok;
}

} // namespace dermis::tools
