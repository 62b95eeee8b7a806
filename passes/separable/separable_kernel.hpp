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
// With this number of taps or more, offsets are whole pixels, and a tap reads the nearest pixel.
// With fewer taps it interpolates between two pixels, because few taps at whole pixels have more
// error.
inline constexpr uint32_t separable_whole_taps = 25;

// Nodes over log2 of the widest channel's d in pixels. Below the first node, that node's
// kernel applies. Above the last node, offsets grow with d.
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

// Returns the number of pixels to a side that the kernel reads at most, also between nodes and with
// the kernel of another pixel of the tile. shaders/separable/kernel.glsl mirrors this function.
int32_t separable_reach_px(double d_px, uint32_t taps);

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

// Returns the device rows of a profile for all choices of taps: separable_rows_per_profile rows.
// For each choice of taps in order, each node has the rows
//
//   0                        weight at 0 {r, g, b, 0}
//   1 .. side                weight at each +-offset {r, g, b, offset px}
//   separable_centre_row     weight of the delta {r, g, b, 0}
//   separable_ends_row       {dense, used, core, 0}, see SeparableEnds
//   separable_decay_row ..   decay of each tap, four per row
//
// with side = (taps - 1) / 2. `d` is per channel, in any unit: only the ratios count. Takes about
// 0.1 s. Thread: any.
using SeparableRow = std::array<float, 4>;
std::vector<SeparableRow> make_separable_rows(const std::array<double, 3>& d);
// Returns the rows of any profile.
std::vector<SeparableRow> make_separable_rows(const ProfileShape& shape);

// A tap whose surface is deeper or nearer than the pixel's has the weight of its offset o times
// (o + core) / (r + core) * 2^(-decay (r - o)) at the distance r in space, with the decay of
// make_separable_decay.
struct SeparableEnds {
  uint32_t dense = 0; // taps of a side whose offsets are 1, 2, 3 ... px
  uint32_t used = 0;  // taps of a side; the others together have less than separable_min_tail
  double core = 0;    // px
};
inline constexpr double separable_min_tail = 1.0 / 4096; // of the kernel's sum, for every channel
// Takes the place of an infinite core, of profiles that are flat at the centre.
inline constexpr double separable_flat_core = 1e6;

// Fills the rows of a node after separable_centre_row from the rows before. `shape` in pixels.
void fill_separable_ends(const ProfileShape& shape, std::span<SeparableRow> node);

// Returns the decay, log2 per pixel, of a tap at an offset in pixels: the mean of the channels'
// decays, weighted by luminance. A channel's decay is that of its profile from the offset to a
// larger distance: sqrt(2) times the offset (a slope of 45 degrees), or d more.
double make_separable_decay(const ProfileShape& shape, double offset);

constexpr uint32_t separable_rows_per_node(uint32_t taps) {
  const uint32_t side = (taps - 1) / 2;
  return side + 3 + (side + 3) / 4;
}
constexpr uint32_t separable_centre_row(uint32_t taps) {
  return (taps - 1) / 2 + 1;
}
constexpr uint32_t separable_ends_row(uint32_t taps) {
  return (taps - 1) / 2 + 2;
}
constexpr uint32_t separable_decay_row(uint32_t taps) {
  return (taps - 1) / 2 + 3;
}
inline constexpr uint32_t separable_rows_per_profile =
    separable_nodes *
    (separable_rows_per_node(11) + separable_rows_per_node(17) + separable_rows_per_node(25));

// On the device each profile has two sets of rows; the pass setting `kernel` selects one.
inline constexpr uint32_t separable_kernel_rows_per_profile = 2 * separable_rows_per_profile;

// Returns row `row` of a node for a widest channel of d_px, interpolated between nodes; `choice`
// indexes separable_taps. shaders/separable/kernel.glsl mirrors this function.
// Meaningless for separable_ends_row.
SeparableRow separable_row(std::span<const SeparableRow> rows, uint32_t choice, double d_px,
                           uint32_t row);

} // namespace dermis::subsurface
