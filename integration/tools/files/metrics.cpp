#include "integration/tools/files/metrics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dermis::tools {

namespace {

// Nearest-rank percentile: the smallest value that at least `fraction` of all values do not exceed.
// Reorders `values`.
template <class T> T percentile(std::vector<T>& values, double fraction) {
  const auto rank = static_cast<size_t>(std::ceil(fraction * double(values.size())));
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(rank > 0 ? rank - 1 : 0);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

} // namespace

void ExposureMeter::add(std::span<const float> light, std::span<const uint8_t> profile) {
  for (size_t i = 0; i < profile.size(); ++i) {
    if (profile[i] == 0) continue;
    const double value = luminance_of(&light[3 * i]);
    if (std::isfinite(value)) luminance.push_back(static_cast<float>(value));
  }
}

double ExposureMeter::result() const {
  if (luminance.empty()) return 1;
  std::vector<float> values = luminance;
  const double bright = percentile(values, 0.999);
  return bright >= min_light ? 1 / bright : 1;
}

double psnr_from_mse(double mse) {
  if (std::isnan(mse)) return -std::numeric_limits<double>::infinity();
  return mse > 0 ? std::min(max_psnr_db, -10 * std::log10(mse)) : max_psnr_db;
}

ErrorFigures measure_error(std::span<const float> image, std::span<const double> reference,
                           std::span<const uint32_t> pixels, double exposure, uint64_t population) {
  ErrorFigures figures;
  figures.pixels = pixels.size();
  if (pixels.empty()) return figures;
  const double count = double(pixels.size());
  std::vector<double> errors(pixels.size());
  double squares = 0, fourths = 0;
  std::array<double, 3> squares_rgb{};
  for (size_t i = 0; i < pixels.size(); ++i) {
    std::array<double, 3> e{};
    for (size_t c = 0; c < 3; ++c) {
      e[c] = (double{image[size_t{3} * pixels[i] + c]} - reference[3 * i + c]) * exposure;
      if (std::isnan(e[c])) e[c] = std::numeric_limits<double>::infinity();
      squares_rgb[c] += e[c] * e[c];
    }
    const double error = luminance_of(e.data());
    errors[i] = std::isnan(error) ? std::numeric_limits<double>::infinity() : std::abs(error);
    squares += errors[i] * errors[i];
    fourths += std::pow(errors[i], 4);
  }
  const double mse = squares / count;
  figures.rmse = std::sqrt(mse);
  figures.psnr_db = psnr_from_mse(mse);
  for (size_t c = 0; c < 3; ++c)
    figures.rmse_rgb[c] = std::sqrt(squares_rgb[c] / count);
  figures.max_error = *std::max_element(errors.begin(), errors.end());
  figures.p99_error = percentile(errors, 0.99);

  // Standard error of the mean of squares with finite-population correction; 1.96 of it each way is
  // the 95 % interval.
  const double left_out =
      std::max(0.0, 1 - count / double(std::max<uint64_t>(population, pixels.size())));
  const double variance =
      pixels.size() > 1 ? std::max(0.0, fourths / count - mse * mse) / (count - 1) : 0;
  const double margin = left_out > 0 ? 1.96 * std::sqrt(variance * left_out) : 0;
  figures.rmse_low = std::sqrt(std::max(0.0, mse - margin));
  figures.rmse_high = std::sqrt(mse + margin);
  return figures;
}

} // namespace dermis::tools
