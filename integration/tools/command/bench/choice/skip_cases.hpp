#pragma once
// Frames that do not need all of a graph: a plane under light that varies per pixel, with various
// parts missing.

#include "integration/tools/files/capture.hpp"

#include <span>
#include <string>
#include <vector>

namespace dermis::tools {

struct SkipCase {
  std::string name;
  CapturedFrame frame;
  bool no_profiles = false;  // create the graph without profiles
  bool empty_bounds = false; // the frame declares that no subsurface is visible
  bool skips = true;         // false: remove the detection of uniform light from the graph
  // Case without skips whose image must be equal. "": not checked, since pixels that scatter below
  // a pixel may differ (copy_below_d_px).
  std::string same_as;
};

// The first case is `full`: the whole image scatters and nothing is skipped. `d_px` is of the
// widest channel.
std::vector<SkipCase> make_skip_cases(uint32_t width, uint32_t height, double d_px,
                                      std::span<const CaptureProfile> profiles);

} // namespace dermis::tools
