#pragma once
// What the demo engine hands out, in the words of the capture folder, which the truth and `apply` understand.

#include "integration/examples/demo_engine/engine.hpp"
#include "integration/tools/files/capture.hpp"

#include <span>
#include <vector>

namespace dermis::tools {

Image to_image(const demo::FloatImage& image);

// The profiles of a scene, read from their files. Errors: input, with all located messages.
demo::Result<std::vector<CaptureProfile>> read_profiles(std::span<const demo::ScatteringProfile> profiles);

// What the graph saw in this frame. Errors: internal (a camera that captures cannot describe).
demo::Result<CapturedFrame> captured_frame(const demo::FrameOutputs& frame,
                                           std::span<const CaptureProfile> profiles);

} // namespace dermis::tools
