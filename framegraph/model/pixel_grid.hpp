#pragma once
// The plan for pixels that are not square. "square_view" is the view with twice the pixels along
// the longer side of a pixel for each doubling, so that its pixels are nearly square. Its halves
// are the levels of pyramids that first halve only the other axis.

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace dermis {

// Kernels get this value as constant_id::pixel_grid. 0: pixels are square. Otherwise 1 + 2 *
// doublings + (1 if pixels are higher than wide and there are doublings).
// shaders/common/pixel_grid.glsl mirrors it.
using PixelGrid = uint32_t;

inline constexpr uint32_t max_pixel_doublings = 2;
// The error of square pixels stays below 1 dB up to this aspect (surface_warnings.hpp).
inline constexpr double largest_square_aspect = 1.07;
// A doubling begins at an aspect of 2^0.58 and 2^1.58, where both choices have equal errors.
inline constexpr double pixel_doubling_bias = 0.42;

// `aspect`: width / height of a pixel, positive.
inline PixelGrid pixel_grid(double aspect) {
  const double octaves = std::abs(std::log2(aspect));
  if (!(octaves > std::log2(largest_square_aspect))) return 0;
  const uint32_t doublings =
      std::min(static_cast<uint32_t>(octaves + pixel_doubling_bias), max_pixel_doublings);
  return 1 + 2 * doublings + (doublings > 0 && aspect < 1 ? 1 : 0);
}
// Returns the doublings of "square_view" along an axis (0: x, 1: y).
constexpr uint32_t pixel_doublings(PixelGrid grid, uint32_t axis) {
  return grid != 0 && (grid - 1) % 2 == axis ? (grid - 1) / 2 : 0;
}
// Returns how often a level of a pyramid halves an axis (0: x, 1: y).
constexpr uint32_t halvings_of_level(PixelGrid grid, uint32_t level, uint32_t axis) {
  return level - std::min(level, pixel_doublings(grid, axis));
}
// Returns the pixels of the view per texel of a level.
constexpr uint64_t pixels_per_texel(PixelGrid grid, uint32_t level) {
  return uint64_t{1} << (halvings_of_level(grid, level, 0) + halvings_of_level(grid, level, 1));
}

} // namespace dermis
