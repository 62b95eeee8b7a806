#pragma once
// FLIP: perceived difference of two images that alternate. Implements the equations of Andersson,
// Nilsson, Akenine-Moller, Oskarsson, Astrom and Fairchild 2020, "FLIP: A Difference Evaluator for
// Alternating Images" (LDR), and Andersson, Nilsson, Shirley and Akenine-Moller 2021, "Visualizing
// Errors in Rendered High Dynamic Range Images" (HDR).

#include "integration/tools/files/image.hpp"

#include <vector>

namespace dermis::tools {

// The papers' viewing setup: 0.7 m from a screen that is 0.7 m and 3840 pixels wide.
inline constexpr double usual_pixels_per_degree = 67;

// Returns a value per pixel from 0 (no visible difference) to 1. Both images have equal size and 1
// or 3 channels of linear light. With `high_range` values may have any brightness and `reference`
// determines the exposures; otherwise values are clamped to 0..1. Non-finite and negative values
// count as 0.
std::vector<float> flip(const Image& reference, const Image& test, bool high_range,
                        double pixels_per_degree = usual_pixels_per_degree);

} // namespace dermis::tools
