#pragma once
// What anti-aliasing over frames would make of a technique's light: a moving mean (weight .1) along surfaces,
// as subsurface.accumulate makes it without clipping.

#include "integration/tools/files/capture.hpp"
#include "passes/common/accumulate.hpp"

#include <vector>

namespace dermis::tools {

class Accumulation {
public:
  // Adds a frame's light (3 values a pixel) and returns the mean so far. `follows`: the frame comes after the
  // one that was added last; else the mean starts anew.
  const std::vector<subsurface::AccumulatedLight>& add(const CapturedFrame& frame,
                                                       const std::vector<float>& light, bool follows);

private:
  std::vector<subsurface::AccumulatedLight> mean_;
  std::vector<float> depth_;     // of the frame before, mm
  std::vector<uint8_t> profile_; // likewise
};

} // namespace dermis::tools
