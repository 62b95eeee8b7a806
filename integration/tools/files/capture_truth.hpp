#pragma once
// A captured frame as the CPU truth takes it: the render rectangle alone, d by profile id.

#include "integration/tools/files/capture.hpp"
#include "passes/common/truth/truth.hpp"

namespace dermis::tools {

struct TruthFrame {
  uint32_t width = 0, height = 0; // of the render rectangle
  subsurface::PixelRays rays;
  std::vector<float> light, depth, scatter_scale;
  std::vector<uint8_t> profile;
  std::vector<subsurface::PerChannel> d_m;
  std::vector<subsurface::ProfileShape> shapes; // of the same ids, metres

  // Refers to this object's arrays.
  subsurface::TruthInput input() const;
};

TruthFrame make_truth_frame(const CapturedFrame& frame);

// Adds the light from behind that comes through to `truth`'s light, as subsurface.transmission does: the
// share that the profile carries further than the thickness. Nothing where the frame has no thickness.
void add_transmission(const CapturedFrame& frame, TruthFrame& truth);

} // namespace dermis::tools
