#pragma once
// Mixing a frame's light into that of earlier frames. shaders/include/accumulate.glsl mirrors these functions
// under the same names.

#include <array>

namespace dermis::subsurface {

// Cubic weights of the four texels around a place (Catmull & Rom 1974), `part` (0..1) beyond the second;
// sum 1.
std::array<double, 4> catmull_rom(double part);

struct AccumulatedLight {
  std::array<double, 3> light{};
  double count = 0; // frames behind it; 0: none
};

// Variance clipping (Salvi 2016): history is drawn along the line to the neighbourhood's mean until it lies
// within `reach` of its standard deviations, and counts for as much less as it was drawn.
AccumulatedLight clip_to_neighbours(const AccumulatedLight& history, const std::array<double, 3>& mean,
                                    const std::array<double, 3>& deviation, double reach);

// A mean of all frames until they weigh less than `least` (0..1] each, then a moving one.
AccumulatedLight add_frame(const AccumulatedLight& history, const std::array<double, 3>& light, double least);

} // namespace dermis::subsurface
