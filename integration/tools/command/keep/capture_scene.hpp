#pragma once
// Frames of a scene as a capture, without a graph: what any graph would see.

#include "integration/examples/demo_engine/result.hpp"
#include "integration/tools/command/verbs.hpp"

#include <string>

namespace dermis::tools {

// Frames `first` .. `first` + `frames` - 1 into the folder `out`, whole or not at all. Progress is told where
// the session wants it. Errors: as rendering, and environment (a folder that cannot be written; stopped).
demo::Result<> capture_scene(const Session& session, const CaptureOptions& options);

} // namespace dermis::tools
