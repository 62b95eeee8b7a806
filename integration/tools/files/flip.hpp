#pragma once
// FLIP: how different two pictures look to somebody who flips between them. After Andersson, Nilsson,
// Akenine-Moller, Oskarsson, Astrom and Fairchild 2020, "FLIP: A Difference Evaluator for Alternating Images"
// (LDR), and Andersson, Nilsson, Shirley and Akenine-Moller 2021, "Visualizing Errors in Rendered High
// Dynamic Range Images" (HDR). Written from the papers' equations.

#include "integration/tools/files/image.hpp"

#include <vector>

namespace dermis::tools {

// Of a reader .7 m away from a screen .7 m and 3840 pixels wide: the papers' own setting.
inline constexpr double usual_pixels_per_degree = 67;

// A value from 0 (nobody sees a difference) to 1 for each pixel. Both pictures have one size and 1 or 3
// channels of linear light; `high_range`: of any brightness, with `reference` deciding how it is exposed;
// else 0..1, clamped. Values that are not finite or below 0 count as 0.
std::vector<float> flip(const Image& reference, const Image& test, bool high_range,
                        double pixels_per_degree = usual_pixels_per_degree);

} // namespace dermis::tools
