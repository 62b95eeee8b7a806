#pragma once
// A captured frame as input of the CPU reference: only the render rectangle, with d per profile id.

#include "integration/tools/files/capture.hpp"
#include "passes/common/reference/reference.hpp"

namespace dermis::tools {

struct ReferenceFrame {
  uint32_t width = 0, height = 0; // size of the render rectangle, pixels
  subsurface::PixelRays rays;
  std::vector<float> light, depth, scatter_scale;
  std::vector<uint8_t> profile;
  std::vector<subsurface::PerChannel> d_m;
  std::vector<subsurface::ProfileShape> shapes; // of the same ids as d_m, metres

  // The result refers to this object's arrays.
  subsurface::ReferenceInput input() const;
};

ReferenceFrame make_reference_frame(const CapturedFrame& frame);

// Adds transmitted back light to the frame's light, as subsurface.transmission does: the fraction
// that the profile carries further than the thickness. Does nothing if the frame has no thickness.
void add_transmission(const CapturedFrame& frame, ReferenceFrame& reference);

} // namespace dermis::tools
