#include "integration/tools/command/bench/choice/scene_run.hpp"
#include "integration/tools/command/bench/suite/suite.hpp"

#include "integration/tools/command/interrupt.hpp"
#include "integration/tools/command/run/rendered_frame.hpp"

#include <fmt/format.h>

namespace dermis::tools {

demo::Result<SceneRun> run_scene(const Session& session, const SceneRunRequest& request,
                                 SharedScene& shared) {
  demo::RenderOptions engine;
  engine.scene = request.scene;
  engine.graph = request.graph;
  engine.hooks = request.hooks;
  engine.model = request.model;
  engine.width = request.size.width;
  engine.height = request.size.height;
  engine.frames = request.frames;
  engine.frames_per_second = request.frames_per_second;
  engine.settings = request.set;
  engine.budget.ms = request.budget_ms;
  engine.budget.deterministic = request.deterministic;
  engine.budget.calibration = request.calibration;
  const auto compared = [&](uint32_t frame) {
    return request.error_every > 0 && frame % request.error_every == request.error_every - 1;
  };
  engine.pictures_of = compared;
  engine.inputs_of = [&](uint32_t frame) {
    return compared(frame) && !shared.references.contains(frame);
  };
  SceneRun run;
  std::vector<CaptureProfile> profiles;
  demo::RenderCallbacks callbacks;
  callbacks.on_start = [&](const demo::RenderInfo& info) {
    run.device = info.device;
    return read_profiles(info.profiles, profiles);
  };
  callbacks.on_frame = [&](const demo::FrameOutputs& frame) -> demo::Result<> {
    if (interrupted()) return stopped();
    RunFrame& out = run.frames.emplace_back();
    out.choice = frame.choice.value_or(demo::FrameChoice{});
    if (!compared(frame.frame) || frame.scattered.texels.empty()) return demo::success();
    auto known = shared.references.find(frame.frame);
    if (known == shared.references.end()) {
      const auto captured = captured_frame(frame, profiles);
      if (!captured) return captured.error();
      auto made =
          make_reference(session, *captured, fmt::format("{} frame {}", request.scene, frame.frame),
                         request.subset, request.cache);
      if (!made) return stopped();
      known = shared.references.emplace(frame.frame, std::move(*made)).first;
    }
    const Reference& reference = known->second;
    if (reference.population > 0)
      out.rmse = measure_error(frame.scattered.texels, reference.light, reference.pixels,
                               reference.exposure, reference.population)
                     .rmse;
    return demo::success();
  };
  const auto summary = demo::render(engine, callbacks, shared.cache.get());
  if (interrupted()) return stopped();
  if (!summary) return summary.error();
  return run;
}

} // namespace dermis::tools
