#pragma once
// The project's error figures, defined in this file only. Errors are of linear Rec. 709 luminance
// of the scattered light before albedo and specular, over pixels with a profile, times one fixed
// exposure per scene; peak 1.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace dermis::tools {

// Luminance weights of linear light (ITU-R BT.709).
inline constexpr std::array<double, 3> rec709 = {0.2126, 0.7152, 0.0722};
template <class Value> double luminance_of(const Value* rgb) {
  return rec709[0] * double(rgb[0]) + rec709[1] * double(rgb[1]) + rec709[2] * double(rgb[2]);
}

// PSNR cap: higher figures only measure rounding.
inline constexpr double max_psnr_db = 100;

// Light below the smallest half float counts as black. Graphs cannot hold such values.
inline constexpr double min_light = 1.0 / (1 << 24);

struct ErrorFigures {
  double rmse = 0, psnr_db = max_psnr_db;
  double max_error = 0, p99_error = 0; // absolute errors; p99 by nearest rank
  double rmse_low = 0, rmse_high = 0;  // 95 % confidence; equal to rmse if all pixels were measured
  std::array<double, 3> rmse_rgb{};    // RMSE per channel
  uint64_t pixels = 0;                 // number of measured pixels
};

// Computes the exposure: the factor that maps the 99.9th percentile (nearest rank) of the
// reference's luminance over pixels with profile != 0 to 1. Call `add` per frame, then `result`.
// The result is 1 if the percentile is below min_light.
struct ExposureMeter {
  std::vector<float> luminance;

  // `light` has 3 values per pixel; non-finite values are left out.
  void add(std::span<const float> light, std::span<const uint8_t> profile);
  double result() const;
};

// Compares `image` (3 values for every pixel of the frame) with `reference` (3 values for each of
// `pixels`, in order). `population` is the number of pixels that the listed ones represent (profile
// != 0 in the frame), at least pixels.size(). A non-finite value of `image` counts as an infinite
// error.
ErrorFigures measure_error(std::span<const float> image, std::span<const double> reference,
                           std::span<const uint32_t> pixels, double exposure, uint64_t population);

// Returns -10 log10(mse), capped at max_psnr_db; minus infinity if `mse` is infinite or NaN.
double psnr_from_mse(double mse);

} // namespace dermis::tools
