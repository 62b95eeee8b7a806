#pragma once
// Device tables of a profile without closed forms: density, survival and inverse as rows over
// radius. shaders/common/profile.glsl reads them (radial_*).

#include "passes/common/profiles/shape.hpp"

#include <vector>

namespace dermis::subsurface {

using RadialRow = std::array<float, 4>;

// Two rows for each of radial_nodes nodes; all rows of the first kind precede all rows of the
// second. Node i of r: log2(r / d) = radial_log2_r_first + i / radial_nodes_per_octave, d of the
// widest channel.
// - First kind: log2(2 pi R_c(r) mm^2) for red, green, blue (at least radial_min_log2), and the
//   inverse: the radius in mm of the widest channel with sqrt(-log2 u) = i /
//   radial_inverse_nodes_per_unit.
// - Second kind: survival for red, green, blue, unused.
inline constexpr uint32_t radial_nodes = 385;
inline constexpr double radial_log2_r_first = -8; // a profile is flat within 1/256 d
inline constexpr double radial_nodes_per_octave = 24;
inline constexpr double radial_inverse_nodes_per_unit = 78; // up to u = 2^-24.2
inline constexpr double radial_min_log2 = -200;
inline constexpr uint32_t radial_rows_per_profile = 2 * radial_nodes;

// Makes the rows. `shape` is in mm; `widest` is the channel with the largest d, which must be
// positive. Takes about 10 ms.
std::vector<RadialRow> make_radial_rows(const ProfileShape& shape, int widest);

} // namespace dermis::subsurface
