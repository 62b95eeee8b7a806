#pragma once
// Draws a technique's error as an image.

#include "integration/tools/command/bench/reference.hpp"
#include "integration/tools/command/bench/report/report.hpp"

namespace dermis::tools {

// A cell of 2x2 pixels (8x8 if the reference is a subset) shows the RMS of the exposed luminance
// error of its measured pixels, on a logarithmic scale from 1e-4 to 1e-1. Subsurface cells without
// a measured pixel take the mean of their neighbours.
ReportPicture heat_map(std::string caption, std::span<const float> light,
                       const Reference& reference, uint32_t width,
                       std::span<const uint8_t> profile);

// Returns the legend of the colours.
std::string heat_map_explanation();

} // namespace dermis::tools
