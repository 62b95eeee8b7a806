#pragma once
// Renders frames that scatter by rays. The demo engine builds the acceleration structures, the
// graph queries them.

#include "integration/tools/command/bench/subject.hpp"
#include "integration/tools/command/graph_input.hpp"

#include <functional>

namespace dermis::tools {

struct RayRequest {
  const LoadedGraph& loaded;
  std::string graph; // file
  std::vector<NamedValue> set;
  uint32_t frames = 1;
  std::function<void()> step = {}; // called after each frame
};

struct RayFrame {
  const std::vector<float>& light; // 3 values per pixel, before albedo
  double device_ms = 0;            // all passes except those that only export light
  // Root mean square luminance of the light that the graph transmits through thin parts by the slab
  // model, in units of `light`. 0: none, or not counted by the graph.
  double slab_rms = 0;
};

// Calls on_frame in order. An error of on_frame or Ctrl-C ends the rendering. Returns credits to
// print. Errors: input, environment (no timestamps, no driver), usage.
demo::Result<std::vector<std::string>>
scatter_by_rays(const RayRequest& request, const SceneRequest& scene, const SubjectOptions& options,
                const std::function<demo::Result<>(const RayFrame&)>& on_frame);

// Returns the reason why this machine cannot trace rays and a remedy, or "".
std::string why_no_rays();

} // namespace dermis::tools
