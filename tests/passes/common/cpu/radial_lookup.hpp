#pragma once
// CPU version of the table reads in shaders/common/profile.glsl.

#include "passes/common/profiles/radial_table.hpp"

#include <span>

namespace dermis::subsurface {

// Return the values that the kernels read from the rows, in fp32; r is in mm, d_mm is that of the
// widest channel.
// 2 pi R_c
std::array<float, 3> radial_falloff(std::span<const RadialRow> rows, float d_mm, float r);
// 1 - cdf_c
std::array<float, 3> radial_survival(std::span<const RadialRow> rows, float d_mm, float r);
struct RadialSample {
  // mm, 1/mm: the exact density with which uniform u in (0, 1] gives r.
  float r = 0, density = 0;
};
RadialSample radial_sample(std::span<const RadialRow> rows, float u);

} // namespace dermis::subsurface
