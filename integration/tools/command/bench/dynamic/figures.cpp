#include "integration/tools/command/bench/dynamic/figures.hpp"

#include "integration/tools/command/bench/still_error.hpp"
#include "integration/tools/files/metrics.hpp"

#include <cmath>
#include <limits>

namespace dermis::tools {
namespace {

constexpr double accumulation = 0.1; // weight of the new frame

// Mean of squares over pixels. A value that is not a number counts as infinite.
struct MeanSquare {
  double sum = 0;
  uint64_t count = 0;
  void add_square(double x) {
    sum += std::isnan(x) ? std::numeric_limits<double>::infinity() : x * x;
    ++count;
  }
  double value() const { return count > 0 ? sum / double(count) : 0; }
};

} // namespace

SequenceFigures sequence_figures(const std::vector<FrameLight>& frames, uint32_t counted,
                                 bool still, double exposure) {
  SequenceFigures figures;
  double frame_sum = 0, shown_sum = 0, accumulated_sum = 0;
  uint32_t used = 0;
  MeanSquare flicker;
  std::vector<double> found_mean, reference_mean;
  for (uint32_t t = 0; t < frames.size(); ++t) {
    const FrameLight& now = frames[t];
    const size_t pixels = now.reference.size() / 3;
    MeanSquare error;
    for (size_t i = 0; i < pixels; ++i)
      error.add_square(exposure *
                       (luminance_of(&now.found[3 * i]) - luminance_of(&now.reference[3 * i])));
    figures.psnr_db.push_back(psnr_from_mse(error.value()));
    if (still) {
      if (found_mean.empty()) {
        found_mean = now.found;
        reference_mean = now.reference;
      }
      for (size_t i = 0; i < found_mean.size(); ++i) {
        found_mean[i] += accumulation * (now.found[i] - found_mean[i]);
        reference_mean[i] += accumulation * (now.reference[i] - reference_mean[i]);
      }
    }
    if (t < counted) continue;
    ++used;
    frame_sum += error.value();
    shown_sum += sdr8_mse(now.found, now.reference, exposure);
    MeanSquare accumulated;
    for (size_t i = 0; !still && i < now.accumulated.size() / 3; ++i)
      accumulated.add_square(
          exposure * (luminance_of(&now.accumulated[3 * i]) - luminance_of(&now.reference[3 * i])));
    for (size_t i = 0; still && i < pixels; ++i) {
      accumulated.add_square(
          exposure * (luminance_of(&found_mean[3 * i]) - luminance_of(&reference_mean[3 * i])));
      if (t == 0) continue;
      const FrameLight& last = frames[t - 1];
      flicker.add_square(
          exposure *
          ((luminance_of(&now.found[3 * i]) - luminance_of(&last.found[3 * i])) -
           (luminance_of(&now.reference[3 * i]) - luminance_of(&last.reference[3 * i]))));
    }
    accumulated_sum += accumulated.value();
  }
  if (used == 0) return figures;
  figures.psnr_db_frame = psnr_from_mse(frame_sum / used);
  figures.psnr_db_sdr8 = psnr_from_mse(shown_sum / used);
  if (still || accumulated_sum > 0)
    figures.psnr_db_accumulated = psnr_from_mse(accumulated_sum / used);
  if (still) figures.flicker = std::sqrt(flicker.value());
  return figures;
}

} // namespace dermis::tools
