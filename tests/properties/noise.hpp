#pragma once
// Random light on a plane, its reference, and the deviation of the mean of many frames from the
// reference.

#include "tests/properties/plane.hpp"

namespace properties {

// Returns an integer hash of the pixel over 256, exact in fp16.
float noise(double x, double y);

// Returns side x side pixels of noise. The channels' d have the ratio of skin; `d` is red's, in
// pixels.
Plane noisy_plane(uint32_t side, double d);

// Returns the sum of kernel times light over the picture, without dividing by the kernel's fraction
// inside the picture. The kernel beyond the cut (20 d) is below 0.1 %.
std::vector<double> unnormalised_reference(const Plane& plane);
// Returns the reference as defined: divided by the kernel's fraction inside the picture.
std::vector<double> normalised_reference(const Plane& plane);

// The deviation of the mean picture from the reference along the direction from the light to the
// reference, in sigmas of the frames' scatter and as a fraction. Positive if too much of the own
// light is kept.
struct Bias {
  double fraction = 0, sigmas = 0;
  double rms = 0; // RMS of one frame's error, over pixels and frames.
};
Bias bias_of(const std::string& graph, const Plane& plane, const std::vector<double>& reference,
             const Settings& settings, uint32_t frames, uint32_t channel = 0);

// Runs 4096 frames and expects their mean within 4 sigma of the reference at every pixel. Returns
// the mean square of these deviations in sigmas of independent frames: 1 +- 0.12 for independent
// frames, less if each frame continues the sequence of the previous frame.
double expect_the_reference_in_the_mean(const std::string& graph, const Settings& settings);

} // namespace properties
