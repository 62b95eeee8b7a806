#pragma once
// Converts output of the demo engine to capture types, which the reference and `apply` accept.

#include "integration/examples/demo_engine/engine.hpp"
#include "integration/tools/files/capture.hpp"

#include <span>
#include <vector>

namespace dermis::tools {

Image to_image(const demo::FloatImage& image);

// Reads the profiles of a scene from their files. Errors: input, with all located messages.
demo::Result<> read_profiles(std::span<const demo::ScatteringProfile> profiles,
                             std::vector<CaptureProfile>& read);

// Returns the graph's inputs of this frame. Errors: internal (a camera that captures cannot
// describe).
demo::Result<CapturedFrame> captured_frame(const demo::FrameOutputs& frame,
                                           std::span<const CaptureProfile> profiles);

} // namespace dermis::tools
