#pragma once
// Patterns of light that generated scenes share.

#include <cstdint>

namespace dermis::tools {

struct Place {
  double x = 0, y = 0; // pixels, integers at pixel centres
};

// Returns a deterministic value in [0, 1).
float hashed(uint32_t x, uint32_t y);

// Returns contrasts at every scale in pixels, independent of the image size.
double texture(Place p);

// Shades a white surface under a key light from the upper left and ambient light. Slopes are d rise
// / d pixel.
double shade(double slope_x, double slope_y);

} // namespace dermis::tools
