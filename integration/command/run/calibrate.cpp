// dermis calibrate: what a graph's passes cost on this device, as a file for budgets.

#include "framegraph/text/json_writer.hpp"
#include "integration/command/interrupt.hpp"
#include "integration/command/output.hpp"
#include "integration/command/run/choice_sets.hpp"
#include "integration/demo_engine/engine.hpp"
#include "integration/demo_engine/files.hpp"

#include <fmt/format.h>

namespace dermis::tools {
namespace {

// Near and far, so that times can be split into what a dispatch and what a tile costs.
constexpr demo::CameraPlace places[] = {
    {{0.03, 0.0, 0.6}, {0.008, -0.027, 0.0}, 25.0},
    {{0.03, 0.0, 2.4}, {0.008, -0.027, 0.0}, 25.0},
};

} // namespace

ExitCode calibrate(const Session& session, const CalibrateOptions& options) {
  Diagnostics diagnostics;
  const std::optional<LoadedGraph> loaded = load_graph(options.graph, options.parts, diagnostics);
  if (!loaded) return fail_graph(session, options.graph, diagnostics);
  const auto all = choice_sets(*loaded, options.size, diagnostics);
  if (all.empty()) return fail_graph(session, options.graph, diagnostics);
  const auto steps = static_cast<uint32_t>(all.size() * std::size(places));
  Progress progress(progress_style(session.quiet, session.json), "calibrate", "run", steps);
  std::string calibration, device;
  if (!options.calibration.empty()) {
    auto text = demo::read_text_file(options.calibration);
    if (!text) return fail(session, static_cast<ExitCode>(text.error().kind), text.error().text);
    calibration = text.take();
  }
  uint32_t done = 0;
  for (const demo::CameraPlace& place : places)
    for (const auto& values : all) {
      demo::RenderOptions engine;
      engine.scene = options.scene;
      engine.roots = options.parts.roots;
      engine.graph = options.graph;
      engine.width = options.size.width;
      engine.height = options.size.height;
      engine.frames = options.frames;
      engine.camera = place;
      engine.settings = values;
      engine.calibration = {done == 0 && !options.calibration.empty() ? options.calibration : "calibration",
                            calibration};
      for (const auto& [name, text] : loaded->overlays)
        engine.overlays.push_back({name, text});
      engine.include = [open = open_beside(options.graph, options.parts.roots)](
                           const std::string& name) -> std::optional<demo::NamedText> {
        const FileText file = open(name);
        return file.problem.empty() ? std::optional(demo::NamedText{file.name, file.text}) : std::nullopt;
      };
      demo::RenderCallbacks callbacks;
      callbacks.on_start = [&](const demo::RenderInfo& info) {
        device = info.device;
        return demo::success();
      };
      callbacks.on_frame = [](const demo::FrameOutputs&) -> demo::Result<> {
        return interrupted() ? demo::Result<>(demo::Error{demo::ErrorKind::environment, "stopped"})
                             : demo::success();
      };
      const auto summary = demo::render(engine, callbacks);
      if (interrupted()) return fail(session, ExitCode::interrupted, "stopped");
      if (!summary) return fail(session, static_cast<ExitCode>(summary.error().kind), summary.error().text);
      calibration = summary->calibration;
      progress.update(++done);
    }
  if (const std::string problem = deliver_text(options.out, calibration); !problem.empty())
    return fail(session, ExitCode::environment, problem);
  say(session, options.out == "-"
                   ? ""
                   : fmt::format("{} holds what {} costs on {}\n", options.out, options.graph, device));
  if (session.json && options.out != "-") {
    JsonWriter answer;
    answer.open_object().member("ok", true).member("out", options.out).member("device", device).close();
    print(std::move(answer).finish());
  }
  return ExitCode::ok;
}

} // namespace dermis::tools
