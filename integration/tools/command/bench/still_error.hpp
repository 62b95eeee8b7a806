#pragma once
// Error figures of a still image of scattered light.

#include "integration/tools/command/bench/reference.hpp"

namespace dermis::tools {

struct StillError {
  ErrorFigures figures;    // linear luminance, exposed
  double psnr_db_sdr8 = 0; // of the tonemapped 8-bit images, all channels; peak 255
  uint64_t population = 0; // subsurface pixels of the frame
};

// Returns the mean square difference of two images, exposed and tonemapped to 8 bits; peak 1. 3
// values per pixel.
double sdr8_mse(std::span<const double> light, std::span<const double> reference, double exposure);

// `light` holds 3 values for every pixel of the frame.
StillError still_error(std::span<const float> light, const Reference& reference);

// Returns the PSNR of `light` against another image instead of the reference's light, at the
// reference's pixels and exposure.
double psnr_between(std::span<const float> light, std::span<const float> other,
                    const Reference& reference);

// Returns the frame with a render rectangle of `side` pixels in its middle, or unchanged if `side`
// is 0. 4,096 samples per pixel are too slow for whole images. Pixels outside do not take part.
CapturedFrame window_of(const CapturedFrame& frame, uint32_t side);
// Returns the reference restricted to the frame's render rectangle, with its exposure.
Reference inside(const CapturedFrame& frame, const Reference& whole);

} // namespace dermis::tools
