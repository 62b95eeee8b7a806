#pragma once
// Error figures of one still picture of scattered light.

#include "integration/tools/command/bench/reference.hpp"

namespace dermis::tools {

struct StillError {
  ErrorFigures figures;    // linear luminance, exposed
  double psnr_db_sdr8 = 0; // of the tonemapped 8-bit pictures, all channels; peak 255
  uint64_t population = 0; // subsurface pixels of the frame
};

// `light`: 3 values for every pixel of the frame.
StillError still_error(std::span<const float> light, const Reference& reference);

// PSNR of `light` against another picture instead of the truth, at the same pixels and exposure.
double psnr_between(std::span<const float> light, std::span<const float> other, const Reference& reference);

// The frame with a square of `side` pixels in its middle as render rectangle, as it is if side is 0: 4,096
// samples a pixel are too many for whole pictures. What lies around it takes no part.
CapturedFrame window_of(const CapturedFrame& frame, uint32_t side);
// The pixels of a reference that lie in a frame's render rectangle; nothing else of it but the exposure.
Reference inside(const CapturedFrame& frame, const Reference& whole);

} // namespace dermis::tools
