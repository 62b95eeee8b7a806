#pragma once
// The project's error figures, as the one set of definitions has them: on linear Rec.709 luminance of the
// scattered light before albedo and specular, over pixels with a profile, times one fixed exposure a scene;
// peak 1.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace dermis::tools {

// ITU-R BT.709 luminance of linear light.
inline constexpr std::array<double, 3> rec709 = {0.2126, 0.7152, 0.0722};
template <class Value> double luminance_of(const Value* rgb) {
  return rec709[0] * double(rgb[0]) + rec709[1] * double(rgb[1]) + rec709[2] * double(rgb[2]);
}

// PSNR is capped here: beyond, the figures are those of rounding.
inline constexpr double max_psnr_db = 100;

// Light below the smallest half float is black: graphs cannot hold it, and rounding leaves as much of
// nothing.
inline constexpr double min_light = 1.0 / (1 << 24);

struct ErrorFigures {
  double rmse = 0, psnr_db = max_psnr_db;
  double max_error = 0, p99_error = 0; // of absolute errors; p99 by nearest rank
  double rmse_low = 0, rmse_high = 0;  // 95 % confidence; equal to rmse when all pixels were measured
  std::array<double, 3> rmse_rgb{};    // the same error a channel
  uint64_t pixels = 0;                 // measured
};

// The factor that puts the 99.9th percentile (nearest rank) of B's luminance over pixels with profile != 0
// at 1. Several frames: call add for each, then result. 1 if that luminance is below min_light.
struct ExposureMeter {
  std::vector<float> luminance;

  // 3 values a pixel; non-finite values are left out.
  void add(std::span<const float> light, std::span<const uint8_t> profile);
  double result() const;
};

// Compares `image` (3 values for every pixel of the frame) with `truth` (3 values for each of `pixels`, in
// order). `population`: how many pixels the listed ones stand for (profile != 0 in the frame); at least
// pixels.size(). A non-finite value of `image` counts as an infinite error.
ErrorFigures measure_error(std::span<const float> image, std::span<const double> reference,
                           std::span<const uint32_t> pixels, double exposure, uint64_t population);

// -10 log10(mse), capped.
double psnr_from_mse(double mse);
// A sequence's PSNR: of the mean of its frames' MSE.
double sequence_psnr(std::span<const ErrorFigures> frames);

} // namespace dermis::tools
