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

// Light of pixels whose surfaces were seen in the frame before as well: sums over them, by channel.
struct LightPairs {
  std::array<double, 3> now{}, before{}, now_squared{}, product{}, before_squared{};
  double pixels = 0;
};
void add_pixel(LightPairs& pairs, const std::array<double, 3>& now, const std::array<double, 3>& before);

// By how much all light of those pixels became brighter, from 0 on; 1 where what they differ by among each
// other explains it, as noise of samples and shadows that move do, and where nothing was lit.
std::array<double, 3> brightness_change(const LightPairs& pairs);

inline constexpr double change_least_pixels = 8; // that tell a change from noise
// Standard errors beyond which a mean has changed: a third of a percent of changes that are none.
inline constexpr double change_sigmas = 3;
// Light that became so many times darker is shown without history, which waits for it to come back; and so
// many times brighter begins anew, because nothing but rounding was left of it.
inline constexpr double change_most = 64;

// A mean of all frames until they weigh less than `least` (0..1] each, then a moving one.
AccumulatedLight add_frame(const AccumulatedLight& history, const std::array<double, 3>& light, double least);

} // namespace dermis::subsurface
