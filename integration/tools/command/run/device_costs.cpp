#include "integration/tools/command/run/device_costs.hpp"

#include "integration/tools/command/interrupt.hpp"

namespace dermis::tools {
namespace {

// One near and one far position separate the cost per dispatch from the cost per tile.
constexpr demo::CameraPlace places[] = {
    {{0.03, 0.0, 0.6}, {0.008, -0.027, 0.0}, 25.0},
    {{0.03, 0.0, 2.4}, {0.008, -0.027, 0.0}, 25.0},
};

} // namespace

uint32_t count_cost_runs(const CostsRequest& request) {
  return static_cast<uint32_t>(request.sets.size() * std::size(places));
}

demo::Result<DeviceCosts> measure_costs(const CostsRequest& request,
                                        const std::function<void()>& on_run) {
  DeviceCosts costs{{}, request.calibration.text};
  const demo::RenderCacheHandle cache = demo::make_render_cache();
  demo::RenderOptions engine;
  engine.scene = request.scene;
  engine.roots = request.roots;
  engine.graph = request.graph;
  engine.graph_text = request.graph_text;
  engine.overlays = request.overlays;
  engine.include = request.include;
  engine.hooks = request.hooks;
  engine.width = request.size.width;
  engine.height = request.size.height;
  engine.frames = request.frames;
  engine.pictures_of = [](uint32_t) { return false; };
  engine.budget.calibration.name =
      request.calibration.text.empty() ? "calibration" : request.calibration.name;
  demo::RenderCallbacks callbacks;
  callbacks.on_start = [&](const demo::RenderInfo& info) {
    costs.device = info.device;
    return demo::success();
  };
  callbacks.on_frame = [&](const demo::FrameOutputs&) -> demo::Result<> {
    if (interrupted()) return stopped();
    return demo::success();
  };
  for (const demo::CameraPlace& place : places)
    for (const auto& values : request.sets) {
      engine.camera = place;
      engine.settings = values;
      engine.budget.calibration.text = costs.calibration;
      const auto summary = demo::render(engine, callbacks, cache.get());
      if (interrupted()) return stopped();
      if (!summary) return summary.error();
      costs.calibration = summary->calibration;
      engine.budget.calibration.name = "calibration"; // the result of the previous run
      on_run();
    }
  return costs;
}

} // namespace dermis::tools
