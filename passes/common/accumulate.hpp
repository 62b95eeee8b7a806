#pragma once
// Mixes a frame's light with that of earlier frames. shaders/common/accumulate.glsl has the same
// functions under the same names.

#include <array>

namespace dermis::subsurface {

// Returns the cubic weights of the four texels around a place (Catmull & Rom 1974), `part` (0..1)
// beyond the second; their sum is 1.
std::array<double, 4> catmull_rom(double part);

struct AccumulatedLight {
  std::array<double, 3> light{};
  double count = 0; // number of accumulated frames; 0: none
};

// Returns the weight of a new frame against `count` frames of history. All frames weigh the same
// until the weight would fall below `minimum` (0..1].
double frame_weight(double count, double minimum);
AccumulatedLight add_frame(const AccumulatedLight& history, const std::array<double, 3>& light,
                           double minimum);

// A lower mean counts as dark, because half floats of light are too coarse there.
inline constexpr double accumulate_min_mean = 1e-6;
// A larger remainder is not kept. Accumulated light is then at most 1 + 1.5 * 4.5 = 7.75 times the
// brightest light around.
inline constexpr double accumulate_largest_remainder = 4.5;

} // namespace dermis::subsurface
