#pragma once
// The separable technique's kernel: delta + rank 1, fitted to the reference for each projected d.
//
//   K(x, y) ~ centre * delta(x, y) + (1 - centre) * a(x) a(y),   a symmetric, non-negative, sum 1
//
// `a` models the actual taps: texels read at offsets 0, +-o_1 .. +-o_M with linear interpolation.
// It is fitted in the frequency domain to the reference's pixel-integrated Burley kernel, weighted
// by the spectrum of natural images. Offsets follow the widest channel; every channel has its own
// weights at them, so that one read serves all three.

#include "passes/common/profiles/shape.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace dermis::subsurface {

// choices, in the order of the pass setting
inline constexpr uint32_t separable_taps[] = {11, 17, 25};
inline constexpr uint32_t separable_max_side = 12; // maximum number of taps on one side

// Nodes over log2 of the widest channel's d in pixels. Below the first node, its kernel is mixed
// with the delta in proportion to d. Above the last node, offsets grow with d.
inline constexpr double separable_first_log2_d = -4.0; // 1/16 px
inline constexpr double separable_log2_d_step = 0.5;
inline constexpr uint32_t separable_nodes = 24; // up to 181 px

// Kernel at one node for one channel.
struct SeparableFit {
  double centre = 1; // weight of the delta
  // `a` at offset 0, then at each of the two +-o_i; the sum over all taps (sides count twice) is 1.
  std::array<double, separable_max_side + 1> weights{1};
  // Root of the weighted mean square error of the fit, relative to no scattering at all.
  double residual = 0;
};

// Returns offsets o_1 .. o_M in pixels for a widest channel of d_px; at least a pixel apart. taps:
// 11, 17 or 25.
std::vector<double> separable_offsets(double d_px, uint32_t taps);

// Fits a channel of d_px at given offsets. d_px >= 0; 0 gives the delta. Takes less than 1 ms.
// Thread: any.
SeparableFit fit_separable(double d_px, std::span<const double> offsets);
// shape in pixels
SeparableFit fit_separable(const ChannelShape& shape, std::span<const double> offsets);

// Returns the transfer function of the reference's kernel on the pixel grid (frequencies in cycles
// per pixel): the continuous transfer 1/4 (1 + k^2 d^2)^-1/2 + 3/4 (1 + 9 k^2 d^2)^-1/2, k = 2 pi
// |f|, times the pixel's box, summed over aliases.
double pixel_kernel_transfer(double d_px, double fx, double fy);
// Returns the transfer function of any profile, shape in pixels. Includes the fraction of light
// that never scatters.
double pixel_kernel_transfer(const ChannelShape& shape, double fx, double fy);

// Returns the device rows of a profile for all choices of taps: separable_rows_per_profile rows {r,
// g, b, offset px}. For each choice of taps in order and each node there are (taps - 1) / 2 + 2
// rows: the weight at 0, the weights at each +-offset, then {centre r, g, b, 0}. `d` is per
// channel, in any unit: only the ratios count. Takes about 0.1 s. Thread: any.
using SeparableRow = std::array<float, 4>;
std::vector<SeparableRow> make_separable_rows(const std::array<double, 3>& d);
// Returns the rows of any profile.
std::vector<SeparableRow> make_separable_rows(const ProfileShape& shape);

constexpr uint32_t separable_rows_per_node(uint32_t taps) {
  return (taps - 1) / 2 + 2;
}
inline constexpr uint32_t separable_rows_per_profile =
    separable_nodes *
    (separable_rows_per_node(11) + separable_rows_per_node(17) + separable_rows_per_node(25));

// On the device each profile has two sets of rows; the pass setting `kernel` selects one.
inline constexpr uint32_t separable_kernel_rows_per_profile = 2 * separable_rows_per_profile;

// Returns row `row` of a node for a widest channel of d_px, interpolated between nodes; `choice`
// indexes separable_taps. shaders/separable/subsurface_separable.comp mirrors this function.
SeparableRow separable_row(std::span<const SeparableRow> rows, uint32_t choice, double d_px,
                           uint32_t row);

} // namespace dermis::subsurface
