#pragma once
// Merges the profiles of many frames, so that a technique's tables and pipelines are created once.

#include "integration/tools/files/capture.hpp"

#include <vector>

namespace dermis::tools {

// Appends the frame's profiles that `merged` lacks, and renumbers the frame's profile ids.
void merge_profiles(std::vector<CaptureProfile>& merged, CapturedFrame& frame);

} // namespace dermis::tools
