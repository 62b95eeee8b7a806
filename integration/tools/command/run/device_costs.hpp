#pragma once
// Measures the cost of a graph's passes on this device: runs each combination of its choices over
// some frames, near and far.

#include "integration/examples/demo_engine/engine.hpp"
#include "integration/tools/command/session.hpp"
#include "integration/tools/command/verbs.hpp"

#include <functional>
#include <string>
#include <vector>

namespace dermis::tools {

struct CostsRequest {
  std::string graph, scene; // files
  std::string graph_text;   // "": that of the file
  std::vector<std::string> roots = {};
  std::vector<demo::NamedText> overlays = {};
  std::function<std::optional<demo::NamedText>(const std::string& name)> include = {};
  Size size;
  uint32_t frames = 0;                       // per run
  std::vector<std::vector<NamedValue>> sets; // one per combination
  demo::NamedText calibration = {};          // initial calibration; "": the library's calibration
  demo::ContextHooks hooks = {};
};

// Returns the number of runs of a request.
uint32_t count_cost_runs(const CostsRequest& request);

struct DeviceCosts {
  std::string device;
  std::string calibration; // JSON
};

// Calls `on_run` after each run. Errors: those of demo::render; environment "stopped" if
// interrupted.
demo::Result<DeviceCosts> measure_costs(const CostsRequest& request,
                                        const std::function<void()>& on_run);

} // namespace dermis::tools
