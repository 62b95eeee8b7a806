#pragma once
// Where a technique errs, as a picture.

#include "integration/tools/command/bench/reference.hpp"
#include "integration/tools/command/bench/report/report.hpp"

namespace dermis::tools {

// One cell of 2x2 pixels (8x8 where the truth is known at a subset only) shows the root mean square of the
// exposed luminance error of its measured pixels, on a logarithmic scale from 1e-4 to 1e-1. Cells of
// subsurface that have no measured pixel take the mean of their neighbours.
ReportPicture heat_map(std::string caption, std::span<const float> light, const Reference& reference,
                       uint32_t width, std::span<const uint8_t> profile);

// What the colours mean, for readers.
std::string heat_map_explanation();

} // namespace dermis::tools
