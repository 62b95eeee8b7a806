#include "integration/tools/command/bench/error_table/light_contrast.hpp"

#include "integration/tools/files/metrics.hpp"

#include <algorithm>
#include <cmath>

namespace dermis::tools {
namespace {

// Statistics of squares of `side` pixels.
struct Squares {
  double contrast = 0, gaps = 0;
};
Squares squares_of(const CapturedFrame& frame, double exposure, uint32_t side) {
  const uint32_t width = frame.description.width, height = frame.description.height;
  double sum = 0, count = 0, with_gaps = 0;
  for (uint32_t top = 0; top < height; top += side)
    for (uint32_t left = 0; left < width; left += side) {
      double low = INFINITY, high = -INFINITY;
      bool gap = false;
      for (uint32_t y = top; y < std::min(top + side, height); ++y)
        for (uint32_t x = left; x < std::min(left + side, width); ++x) {
          const size_t i = size_t{y} * width + x;
          if (frame.profile[i] == 0) {
            gap = true;
            continue;
          }
          const double light = exposure * luminance_of(&frame.lighting.values[3 * i]);
          low = std::min(low, light);
          high = std::max(high, light);
        }
      if (high < low) continue;
      ++count;
      with_gaps += gap;
      sum += std::pow(std::min(high - low, 1.0), 2);
    }
  if (count == 0) return {};
  return {std::sqrt(sum / count), with_gaps / count};
}

} // namespace

FrameKeys keys_of(const CapturedFrame& frame, double exposure) {
  constexpr uint32_t tile = 8, cell = 32;
  const Squares tiles = squares_of(frame, exposure, tile);
  return {tiles.contrast, squares_of(frame, exposure, cell).contrast, tiles.gaps};
}

} // namespace dermis::tools
