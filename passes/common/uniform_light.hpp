#pragma once
// Where light is flat: a tile in which, and as far around it as light reaches, all subsurface has the same
// light keeps its own. The numbers that shaders/common/subsurface_classify_uniform_light.comp decides by.

#include <cstdint>

namespace dermis::subsurface {

// Light reaches this many d: beyond lies exp(-20) / 4 + 3/4 exp(-20/3) = 9.5e-4 of Burley's profile
// (Christensen & Burley 2015). It is the radius of the truth, too.
inline constexpr double flat_reach_d = 20;
// Light counts as the same where it differs by at most this share of the tile's greatest: half of a step of 8
// bits. The picture changes by no more, and by what the tail beyond the reach weighs.
inline constexpr double flat_tolerance = 1.0 / 512;
// Tiles to a side: wider scattering is never looked at, since a tile would look at more tiles than it has
// pixels to save.
inline constexpr int32_t flat_max_reach = 24;
// Tiles to a side of a cell, whose light is looked at in one step.
inline constexpr uint32_t flat_cell_side = 4;

} // namespace dermis::subsurface
