#pragma once
// Names the usual mistakes of an engine's first frame, from a captured frame: what `dermis validate
// FRAMES --diagnose` reports. Every finding is an estimate from the images, so it states its figures.

#include "integration/tools/files/capture.hpp"

#include <string>

namespace dermis::tools {

// Adds a diagnostic D0520 to D0526 per finding, located at frame.json. Returns one line of figures about
// the frame: pixels with a profile, projected d, depths.
std::string diagnose_frame(const CapturedFrame& frame, const SourceLocation& frame_json,
                           Diagnostics& diagnostics);

} // namespace dermis::tools
