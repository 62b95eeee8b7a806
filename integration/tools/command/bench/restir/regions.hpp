#pragma once
// Splits an image by the way light reaches its pixels, and measures the error of each region.

#include "integration/tools/command/bench/reference.hpp"

namespace dermis::tools {

// `all` holds all pixels of a reference. `through` holds pixels with transmitted light: the back
// light exceeds the front light, and the distance through the object is at most `thin_mm`. `rest`
// holds the others.
struct RayRegions {
  Reference all, through, rest;
};
RayRegions split_by_light(const Reference& reference, const CapturedFrame& frame, double thin_mm);

struct RegionError {
  double mse = 0;   // exposed luminance
  double light = 0; // mean luminance relative to the reference; 1: no loss
};

struct LightError {
  RegionError all, through, rest; // 0 in a region without pixels
};

// `light` holds 3 values per pixel of the frame.
LightError measure_light(std::span<const float> light, const RayRegions& regions);
// Returns the mean over several frames.
LightError mean_of(std::span<const LightError> frames);

} // namespace dermis::tools
