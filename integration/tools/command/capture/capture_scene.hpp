#pragma once
// Captures frames of a scene without a graph, as inputs for any graph.

#include "integration/examples/demo_engine/result.hpp"
#include "integration/tools/command/verbs.hpp"

#include <string>

namespace dermis::tools {

// Writes frames `first` .. `first` + `frames` - 1 into the folder `out`, atomically. Shows progress
// according to the session. Errors: those of rendering, and environment (an unwritable folder, or
// an interrupt).
demo::Result<> capture_scene(const Session& session, const CaptureOptions& options);

} // namespace dermis::tools
