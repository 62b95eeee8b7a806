#pragma once
// Parts of a picture that light reaches in different ways, and how far off light is in each.

#include "integration/tools/command/bench/reference.hpp"

namespace dermis::tools {

// One for all pixels of a reference, one for those that light comes through: the light from behind is more
// than that in front, and its way through the thing at most `thin_mm`; one for the rest.
struct RayRegions {
  Reference all, through, rest;
};
RayRegions split_by_light(const Reference& reference, const CapturedFrame& frame, double thin_mm);

struct RegionError {
  double mse = 0;   // exposed luminance
  double light = 0; // mean luminance, over the reference's; 1: as much as there is
};

struct LightError {
  RegionError all, through, rest; // those of a region without pixels are 0
};

// `light`: 3 a pixel of the frame.
LightError measure_light(std::span<const float> light, const RayRegions& regions);
// Of several frames.
LightError mean_of(std::span<const LightError> frames);

} // namespace dermis::tools
