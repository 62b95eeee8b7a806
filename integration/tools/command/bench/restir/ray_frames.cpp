#include "integration/tools/command/bench/restir/ray_frames.hpp"

#include "integration/tools/command/bench/technique.hpp"
#include "integration/tools/command/interrupt.hpp"

#include <algorithm>

namespace dermis::tools {
namespace {

double device_ms_of(const demo::FrameOutputs& frame, const LoadedGraph& loaded) {
  double sum = 0;
  for (const demo::PassTime& one : frame.dermis_times) {
    const auto& passes = loaded.graph.passes;
    const auto pass = std::find_if(passes.begin(), passes.end(), [&](const PassDeclaration& each) {
      return each.name == one.pass;
    });
    if (pass == passes.end() || loaded.pass_types[pass->type].name != export_scattered_type)
      sum += one.milliseconds;
  }
  return sum;
}

} // namespace

demo::Result<std::vector<std::string>>
scatter_by_rays(const RayRequest& request, const SceneRequest& scene, const SubjectOptions& options,
                const std::function<demo::Result<>(const RayFrame&)>& on_frame) {
  demo::RenderOptions engine;
  engine.scene = scene.file;
  engine.camera = scene.camera;
  if (scene.model) engine.model = options.model;
  engine.graph = request.graph;
  engine.width = options.width;
  engine.height = options.height;
  engine.frames = request.frames;
  engine.settings = settings_as_json(request.loaded.graph, request.set);
  std::vector<std::string> credits;
  demo::RenderCallbacks callbacks;
  callbacks.on_start = [&](const demo::RenderInfo& info) {
    credits = info.credits;
    return demo::success();
  };
  callbacks.on_frame = [&](const demo::FrameOutputs& frame) -> demo::Result<> {
    if (interrupted()) return stopped();
    if (frame.dermis_times.empty())
      return demo::Error{demo::ErrorKind::environment,
                         "the device has no timestamps; nothing can be compared"};
    const double slab_rms =
        frame.choice ? frame.choice->transmitted_rms / double(frame.exposure) : 0;
    auto done = on_frame({frame.scattered.texels, device_ms_of(frame, request.loaded), slab_rms});
    if (done && request.step) request.step();
    return done;
  };
  if (auto done = demo::render(engine, callbacks); !done) return done.error();
  return credits;
}

} // namespace dermis::tools
