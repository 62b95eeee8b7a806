#pragma once
// Weights of the pyramid levels in a pixel for a given d. They are fitted to the reference's
// kernel, so that the surface-aware pyramid (SAP) reproduces the profile on a plane that faces the
// viewer.

#include "framegraph/model/pixel_grid.hpp"
#include "passes/common/profiles/shape.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace dermis::subsurface {

// Variants of the pyramid. A level l >= 1 is computed by l reductions with [1 3 3 1] / 8 and l
// bilinear expansions: its transfer function is the product of cos^6(pi f 2^k) over k < l and both
// axes.
// - `smooth` first filters every level with a 3x3 tent (cos^2(pi f 2^l)), which hides the grid's
//   phase. Level 0 has its centre and its tent.
// - `base` filters only level 1 and uses the others as they are. Level 0 has its centre and its
//   tent.
// - `half` is base without the tent of level 0 and with a level 1 of plain 2x2 means (cos(pi f) in
//   place of cos^3), for kernels that store no level 0.
// - `plain` is the pyramid without surface: each level is read by the pixel itself through a cubic
//   B-spline, including level 0 (in place of the tent).
enum class SapVariant : uint8_t { base, smooth, half, plain };
inline constexpr uint32_t sap_variant_count = 4;

inline constexpr uint32_t sap_level_count = 9; // 0 to 8, spacing 1 to 256 px

// From this level on, tents have three taps on each axis. Their variance is limited, because they
// amplify the finest waves above it: measured on planes with pixels of 4:3.
inline constexpr uint32_t sap_first_short_tent = 4;
inline constexpr double sap_max_short_variance = 0.7;

// How the pyramid follows the shape of a pixel. The first levels halve only the axis with the
// shorter sides; the tents of all levels are wider along the shorter side of a texel. Here x is the
// axis of the longer side of a pixel, or of either side if no level halves one axis.
struct SapShape {
  uint32_t halvings = 0;  // number of first levels that halve only y
  double log2_aspect = 0; // log2 of width / height of a texel of level `halvings`

  // Return the sides of a pixel along an axis (0: x, 1: y), whose product is 1, and the distance of
  // texels of a level in pixels.
  double side(uint32_t axis) const;
  double spacing(uint32_t axis, uint32_t level) const;
  bool halves(uint32_t axis, uint32_t level) const { return axis == 1 || level > halvings; }
  // Returns the weights of a level's tent along an axis at the distances of 0, 1 and 2 texels.
  // Their variances give levels equal widths along both axes, in lengths; they are 1/2 (1/2, 1/4,
  // 0) if pixels are square. shaders/sap/sap_tent.glsl mirrors this function.
  std::array<double, 3> tent(uint32_t axis, uint32_t level) const;
};
// Shapes with tables, for every number of halvings: equal steps of log2_aspect, from
// -sap_last_log2_aspect to it, or from 0 if no level halves one axis only.
inline constexpr uint32_t sap_shape_nodes = 5; // odd
inline constexpr double sap_last_log2_aspect = 0.6, sap_log2_aspect_step = 0.3;
// Returns the shapes with tables in the order of the tables; a single square for grid 0.
std::vector<SapShape> sap_shapes(PixelGrid grid);

// centre, tent of level 0, levels 1 to 8
inline constexpr uint32_t sap_weight_count = sap_level_count + 1;
// Returns the coarsest level that base, half or smooth filters with a tent.
constexpr uint32_t sap_last_tent(SapVariant variant) {
  return variant == SapVariant::smooth ? sap_level_count - 1 : 1;
}
inline constexpr uint32_t sap_nodes_per_octave = 4;
// d = 0.0526 px: just below the limit under which pixels are copied.
inline constexpr double sap_log2_d_first = -4.25;
inline constexpr uint32_t sap_node_count = 48; // up to d = 181 px

// The weights for one d. Non-negative; their sum is 1 within 1e-14.
using SapWeights = std::array<double, sap_weight_count>;

struct SapNode {
  double d_px = 0;
  SapWeights weights{};
  // RMS error of the transfer function under the fit's weight (sap_weights.cpp)
  double residual = 0;
};

struct SapFit {
  SapVariant variant = SapVariant::smooth;
  std::array<SapNode, sap_node_count> nodes;
};

// Fits the weights for Burley's profile by non-negative least squares at each node. Deterministic;
// takes tens of milliseconds. Thread: any.
SapFit fit_sap_weights(SapVariant variant);
// Fits the weights for another profile: `shape` in any unit, nodes by its d in pixels. The fraction
// of light that never scatters is part of the centre's weight.
SapFit fit_sap_weights(SapVariant variant, const ChannelShape& shape, const SapShape& pixel = {});
// Fits several variants in little more time than one, because they have the same target.
std::vector<SapFit> fit_sap_weights(std::span<const SapVariant> variants, const ChannelShape& shape,
                                    const SapShape& pixel = {});

// Weights for the kernels, as fractions of the remaining light at each level: out = mix(coarser,
// level l, t_l). centre and tent are level 0's weights; fraction[l] = W_l / sum of W_k over k >= l
// for l >= 1, fraction[8] = 1.
struct SapFractions {
  double centre = 1, tent = 0;
  std::array<double, sap_level_count> fraction{}; // fraction[0] is unused
};
SapFractions sap_fractions(const SapWeights& weights);

// The device's table. Its rows are centre, tent, and fraction[1] to fraction[8]. For each pair of
// rows and each node it has four floats: both rows at the node, then both rows at the next node
// (the last node has itself as the next). A pixel thus reads all that it interpolates as one vec4.
inline constexpr uint32_t sap_table_rows = sap_weight_count;
inline constexpr uint32_t sap_table_pairs = sap_table_rows / 2;
inline constexpr size_t sap_table_floats = size_t{sap_table_pairs} * sap_node_count * 4;
std::vector<float> make_sap_table(const SapFit& fit);

// Returns row `row` of the table at d px, linear in log2 d. From the first node to d = 0 the weight
// of the centre (row 0) rises to 1 and that of the tent (row 1) falls to 0, linearly in d; other
// rows keep the first value. Beyond the last node the last value applies.
// shaders/sap/sap.glsl mirrors this function.
template <class Real> Real sap_lookup(std::span<const float> table, uint32_t row, Real d_px);

} // namespace dermis::subsurface
