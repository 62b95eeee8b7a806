#pragma once
// Mixes a frame's light with that of earlier frames. shaders/common/accumulate.glsl mirrors these functions
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

// Weight of a new frame against `count` frames of history: all frames weigh the same until a frame weighs
// `least` (0..1].
double frame_weight(double count, double minimum);
AccumulatedLight add_frame(const AccumulatedLight& history, const std::array<double, 3>& light,
                           double minimum);

// Less brightness than this counts as dark: half floats of light say too little there.
inline constexpr double accumulate_min_brightness = 1e-6;
// A remainder beyond this is not kept. Light over frames is then at most 1 + 1.5 * 4.5 = 7.75 times the
// brightest light around.
inline constexpr double accumulate_largest_remainder = 4.5;

// What history keeps of a pixel's scattered light: the part that the nearest pixels (`near`) do not explain,
// over the brightness around.
std::array<double, 3> remainder_of(const std::array<double, 3>& light, const std::array<double, 3>& near,
                                   const std::array<double, 3>& brightness);
bool can_be_kept(const std::array<double, 3>& remainder);
// The light that a remainder stands for under this frame's light; never below 0.
std::array<double, 3> light_of_remainder(const std::array<double, 3>& remainder,
                                         const std::array<double, 3>& near,
                                         const std::array<double, 3>& brightness);

} // namespace dermis::subsurface
