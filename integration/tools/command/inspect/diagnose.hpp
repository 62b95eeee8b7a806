#pragma once
// Finds usual mistakes in an engine's first frame from a captured frame, for `dermis validate
// FRAMES --diagnose`. Findings are estimates from the images and state their figures.

#include "integration/tools/files/capture.hpp"

#include <string>

namespace dermis::tools {

// Adds a diagnostic D0520 to D0526 per finding, located at frame.json. Returns one line of figures
// about the frame: pixels with a profile, projected d, depths.
std::string diagnose_frame(const CapturedFrame& frame, const SourceLocation& frame_json,
                           Diagnostics& diagnostics);

} // namespace dermis::tools
