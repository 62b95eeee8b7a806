#pragma once
// Frames that the demo engine scatters by rays: it builds the acceleration structures, the graph asks them.

#include "integration/tools/command/bench/subject.hpp"
#include "integration/tools/command/graph_input.hpp"

#include <functional>

namespace demo {
struct VulkanHost;
}

namespace dermis::tools {

struct RayRequest {
  const LoadedGraph& loaded;
  std::string graph; // its file
  std::vector<NamedValue> set;
  uint32_t frames = 1;
  std::function<void()> step = {}; // called after each frame
};

struct RayFrame {
  const std::vector<float>& light; // 3 a pixel, before albedo
  double device_ms = 0;            // all passes but those that only hand light to tools
  // What the graph counted of light through thin parts, as a slab lets it through: root mean square, of the
  // luminance that `light` has. 0: none, or the graph does not count it.
  double slab_rms = 0;
};

// Calls on_frame in order; an error of it ends the rendering, and so does Ctrl-C. Returns credits to be
// printed. Errors: input, environment (no timestamps, no driver), usage.
demo::Result<std::vector<std::string>>
scatter_by_rays(const RayRequest& request, const SceneRequest& scene, const SubjectOptions& options,
                const std::function<demo::Result<>(const RayFrame&)>& on_frame);

// Why the device cannot do so, and what could; "" when it can.
std::string why_no_rays(const demo::VulkanHost& host);

} // namespace dermis::tools
