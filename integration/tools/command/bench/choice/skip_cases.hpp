#pragma once
// Frames that do not need all of a graph: a plane under light that varies from pixel to pixel, and what can
// be missing.

#include "integration/tools/files/capture.hpp"

#include <span>
#include <string>
#include <vector>

namespace dermis::tools {

struct SkipCase {
  std::string name;
  CapturedFrame frame;
  bool no_profiles = false;  // the graph is made without profiles
  bool empty_bounds = false; // the frame says that nothing with subsurface is to be seen
  bool skips = true;         // false: the graph is cut down to what never looks for flat light
  // The case whose picture this one's must be, made without skips; "": none, since the picture may differ by
  // what a pixel that scatters less than itself would lose (kinds.hpp, copy_below_d_px).
  std::string same_as;
};

// The first case is `full`: all of the picture scatters and nothing is skipped. `d_px`: of the widest
// channel.
std::vector<SkipCase> make_skip_cases(uint32_t width, uint32_t height, double d_px,
                                      std::span<const CaptureProfile> profiles);

} // namespace dermis::tools
