#pragma once
// Uniform light: a tile keeps its own light if all subsurface in it, and around it as far as light
// reaches, has the same light. shaders/common/subsurface_classify_uniform_light.comp uses these
// constants.

#include <cstdint>

namespace dermis::subsurface {

// Light reaches this many d: exp(-20) / 4 + 3/4 exp(-20/3) = 9.5e-4 of Burley's profile lies beyond
// (Christensen & Burley 2015). The reference uses the same radius.
inline constexpr double uniform_reach_d = 20;
// Light counts as uniform if it differs by at most this fraction of the tile's maximum: half of a
// step of 8 bits. The picture changes by at most this fraction, plus the weight of the tail beyond
// the reach.
inline constexpr double uniform_tolerance = 1.0 / 512;
// Maximum reach in tiles in each direction. With wider scattering the test is left out, because it
// would read more than the kernel whose work it saves.
inline constexpr int32_t uniform_max_reach = 24;
// Side of a cell in tiles; the light of a cell is tested in one step.
inline constexpr uint32_t uniform_cell_side = 4;

} // namespace dermis::subsurface
