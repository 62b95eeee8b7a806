#pragma once
// Light without order on a plane, its truth, and how far the mean of many frames is from it.

#include "tests/properties/plane.hpp"

namespace properties {

// An integer hash of the pixel over 256, exact in fp16.
float noise(double x, double y);

// side x side pixels of noise, d of the channels in the ratio of skin; `d` is red's, in pixels.
Plane noisy_plane(uint32_t side, double d);

// Sum of kernel times light over the picture, without dividing by the kernel's share inside of it. What is
// beyond the cut (20 d) holds below .1 % of the kernel.
std::vector<double> unnormalised_reference(const Plane& plane);
// The truth as it is defined: divided by the kernel's share inside of the picture.
std::vector<double> normalised_reference(const Plane& plane);

// How far the mean of a picture is from the truth along the direction from the light to the truth, in sigmas
// of the frames' scatter and as a share: positive where too much of the own light is kept.
struct Bias {
  double fraction = 0, sigmas = 0;
  double rms = 0; // of one frame's error, over pixels and frames
};
Bias bias_of(const std::string& graph, const Plane& plane, const std::vector<double>& reference,
             const Settings& settings, uint32_t frames, uint32_t channel = 0);

// Runs 4096 frames and expects their mean within 4 sigma of the truth at every pixel. Returns the mean square
// of those deviations in sigmas of independent frames: 1 +- .12 where frames are independent, less where each
// goes on where the one before ended.
double expect_the_reference_in_the_mean(const std::string& graph, const Settings& settings);

} // namespace properties
