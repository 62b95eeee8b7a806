#pragma once
// How far two pictures are apart, without a truth or profiles: for `dermis compare`.

#include "integration/tools/files/image.hpp"

#include <cstdint>
#include <optional>

namespace dermis::tools {

struct PixelRectangle {
  uint32_t x = 0, y = 0, width = 0, height = 0;
};

// Values with peak 1: encoded ones of a PNG; of linear light, Rec.709 luminance times an exposure.
struct Difference {
  double psnr_db = 0, rmse = 0; // PSNR capped at max_psnr_db of metrics.hpp
  // Structural similarity (Wang and others 2004), 11x11 Gaussian window, sigma 1.5; -1..1. None where pixels
  // are left out: its windows would have holes.
  std::optional<double> ssim;
  double max_error = 0;
  uint32_t worst_x = 0, worst_y = 0; // where, in the pictures
  uint64_t nonfinite = 0; // pixels with a value that is not finite in either; they count as an error of 1
  uint64_t pixels = 0;    // that were compared
};

// Encodes linear channels as a PNG would, so that differences are those that are seen.
Image encoded(const Image& linear);

// The luminance of 3 channels, or the one channel there is, times `exposure`.
Image exposed_luminance(const Image& light, double exposure);
// The factor that puts the 99.9th percentile of a picture's luminance at 1; 1 where that is below min_light
// (metrics.hpp). `mask`, if there is one, as below.
double exposure_of(const Image& light, const Image* mask = nullptr);

// Inside `where`, which must lie in both; the pictures have one size and number of channels. Of `mask`, of
// their size and with one channel, pixels that are 0 are left out; none where it is null.
Difference compare_pictures(const Image& a, const Image& b, const PixelRectangle& where,
                            const Image* mask = nullptr);

} // namespace dermis::tools
