#pragma once
// Relief of a frame: how much of the surface around its pixels leaves their tangent planes. A key
// of the error table: techniques that assume a flat surface around a pixel become less accurate as
// relief grows.

#include "passes/common/reference/reference.hpp"

namespace dermis::subsurface {

// Points at these distances, in d of the widest channel, are compared with the plane.
inline constexpr double relief_near_d = 1.25, relief_far_d = 3.5;
inline constexpr double relief_max_offset = 32768; // pixels; beyond any picture
inline constexpr double relief_turn = 2.39996323; // angle between points, radians: the golden angle
// Standard deviation of the distance from the plane that counts as on it, relative to the distance
// of the point.
inline constexpr double relief_width = 0.87;
// Distance from the plane, in d, that divides the light that arrives by e.
inline constexpr double relief_range_d = 2;

// Returns the mean relief as subsurface.classify counts it: in half of the blocks of 4x4 tiles, at
// one pixel per two rows of each tile that scatters. 0: all surfaces are flat within reach of
// scattering; at most 1; -1: nothing scatters. Thread: any.
double mean_relief(const ReferenceInput& input);

} // namespace dermis::subsurface
