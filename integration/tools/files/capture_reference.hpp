#pragma once
// A captured frame as the CPU truth takes it: the render rectangle alone, d by profile id.

#include "integration/tools/files/capture.hpp"
#include "passes/common/reference/reference.hpp"

namespace dermis::tools {

struct ReferenceFrame {
  uint32_t width = 0, height = 0; // of the render rectangle
  subsurface::PixelRays rays;
  std::vector<float> light, depth, scatter_scale;
  std::vector<uint8_t> profile;
  std::vector<subsurface::PerChannel> d_m;
  std::vector<subsurface::ProfileShape> shapes; // of the same ids, metres

  // Refers to this object's arrays.
  subsurface::ReferenceInput input() const;
};

ReferenceFrame make_reference_frame(const CapturedFrame& frame);

// Adds the light from behind that comes through to `truth`'s light, as subsurface.transmission does: the
// share that the profile carries further than the thickness. Nothing where the frame has no thickness.
void add_transmission(const CapturedFrame& frame, ReferenceFrame& reference);

} // namespace dermis::tools
