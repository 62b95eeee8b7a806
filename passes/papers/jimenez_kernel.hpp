#pragma once
// The published separable kernel, as a baseline: the artist-friendly profile sampled along each axis (Jimenez
// et al. 2015, "Separable subsurface scattering", section 3.6).

#include "passes/separable/separable_kernel.hpp"

namespace dermis::subsurface {

// One channel of one axis: weights at offset 0 and at each of the two +-o_i, sum 1 (sides twice). The profile
// itself, not its line integral, is taken at each tap, times the length that the tap stands for; then the
// centre is mixed towards 1 by the strength.
std::vector<double> jimenez_weights(std::span<const double> offsets, double width, double strength);
// Offsets o_1 .. o_M for red skin at width 1, mm: range (i / M)^2, range 3 above 20 taps, else 2.
std::vector<double> jimenez_offsets(uint32_t taps);

// Rows in the layout of make_separable_rows, the same kernel at every node, stretched with d; the delta's
// weight is 0, since strength works on each axis. An artist-friendly profile gives its own widths and
// strengths. For another model the kernel stands in: widths in the ratios of the channels' d, strength 1, the
// widest stretched to the same radius of 99 % of its energy.
std::vector<SeparableRow> make_jimenez_rows(const ProfileShape& shape);

} // namespace dermis::subsurface
