#pragma once
// Baseline: the published separable kernel, which samples the artist-friendly profile along each
// axis (Jimenez et al. 2015, "Separable subsurface scattering", section 3.6).

#include "passes/separable/separable_kernel.hpp"

namespace dermis::subsurface {

// Returns one channel of one axis: weights at offset 0 and at each of the two +-o_i, sum 1 (sides
// count twice). Each tap has the profile itself, not its line integral, times the length that the
// tap represents. The strength then blends the centre towards 1.
std::vector<double> jimenez_weights(std::span<const double> offsets, double width, double strength);
// Returns offsets o_1 .. o_M for red skin at width 1, mm: range (i / M)^2, range 3 above 20 taps,
// else 2.
std::vector<double> jimenez_offsets(uint32_t taps);

// Returns rows in the layout of make_separable_rows, with one kernel at every node, stretched with
// d. The weight of the delta is 0, because strength works on each axis. An artist-friendly profile
// has its own widths and strengths. For another model, widths have the ratios of the channels' d,
// the strength is 1, and the widest kernel is stretched to the same radius of 99 % of its energy.
std::vector<SeparableRow> make_jimenez_rows(const ProfileShape& shape);

} // namespace dermis::subsurface
