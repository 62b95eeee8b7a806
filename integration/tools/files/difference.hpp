#pragma once
// Compares two images without a reference or profiles, for `dermis compare`.

#include "integration/tools/files/image.hpp"

#include <cstdint>
#include <optional>

namespace dermis::tools {

struct PixelRectangle {
  uint32_t x = 0, y = 0, width = 0, height = 0;
};

// Values have peak 1: sRGB-encoded values of a PNG, or Rec. 709 luminance of linear light times an
// exposure.
struct Difference {
  double psnr_db = 0, rmse = 0; // PSNR is capped at max_psnr_db of metrics.hpp
  // Structural similarity (Wang et al. 2004), 11x11 Gaussian window, sigma 1.5; -1..1. Not set if a
  // mask leaves pixels out, since windows would have holes.
  std::optional<double> ssim;
  double max_error = 0;
  uint32_t worst_x = 0, worst_y = 0; // position of max_error in the images, pixels
  // Pixels with a non-finite value in either image. Each counts as an error of 1.
  uint64_t nonfinite = 0;
  uint64_t pixels = 0; // number of compared pixels
};

// Encodes linear channels in sRGB as a PNG does, so that differences match perceived ones.
Image encoded(const Image& linear);

// Returns the luminance of 3 channels, or the only channel, times `exposure`.
Image exposed_luminance(const Image& light, double exposure);
// Returns the factor that maps the 99.9th percentile of the luminance to 1. Returns 1 if the
// percentile is below min_light (metrics.hpp). `mask` is as in compare_pictures.
double exposure_of(const Image& light, const Image* mask = nullptr);

// Compares the pixels inside `where`, which must lie in both images. Both images must have equal
// size and channel count. `mask` is null or a one-channel image of equal size; pixels where the
// mask is 0 are left out.
Difference compare_pictures(const Image& a, const Image& b, const PixelRectangle& where,
                            const Image* mask = nullptr);

} // namespace dermis::tools
