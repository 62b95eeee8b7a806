#pragma once
// Temporal anti-aliasing of a technique's light: a moving mean (weight 0.1) along surfaces, as
// subsurface.accumulate computes without clipping.

#include "integration/tools/files/capture.hpp"
#include "passes/common/accumulate.hpp"

#include <vector>

namespace dermis::tools {

class Accumulation {
public:
  // Adds a frame's light (3 values per pixel) and returns the mean so far. If `follows` is false,
  // the frame does not follow the last added frame and the mean restarts.
  const std::vector<subsurface::AccumulatedLight>&
  add(const CapturedFrame& frame, const std::vector<float>& light, bool follows);

private:
  std::vector<subsurface::AccumulatedLight> mean_;
  std::vector<float> depth_;     // of the previous frame, mm
  std::vector<uint8_t> profile_; // of the previous frame
};

} // namespace dermis::tools
