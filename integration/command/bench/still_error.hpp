#pragma once
// Error figures of one still picture of scattered light.

#include "integration/command/bench/reference.hpp"

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

} // namespace dermis::tools
