#pragma once
// What a graph's passes cost on this device: each combination of its choices runs over some frames, near and
// far.

#include "integration/examples/demo_engine/engine.hpp"
#include "integration/tools/command/session.hpp"
#include "integration/tools/command/verbs.hpp"

#include <functional>
#include <string>
#include <vector>

namespace dermis::tools {

struct CostsRequest {
  std::string graph, scene; // files
  std::vector<std::string> roots = {};
  std::vector<demo::NamedText> overlays = {};
  std::function<std::optional<demo::NamedText>(const std::string& name)> include = {};
  Size size;
  uint32_t frames = 0;                       // of each run
  std::vector<std::vector<NamedValue>> sets; // one for each combination
  demo::NamedText calibration = {};          // to begin from; "": the library's own
  demo::ContextHooks hooks = {};
};

// Runs of a request.
uint32_t count_cost_runs(const CostsRequest& request);

struct DeviceCosts {
  std::string device;
  std::string calibration; // JSON
};

// Calls `on_run` after each run. Errors: those of demo::render; environment "stopped" when interrupted.
demo::Result<DeviceCosts> measure_costs(const CostsRequest& request, const std::function<void()>& on_run);

} // namespace dermis::tools
