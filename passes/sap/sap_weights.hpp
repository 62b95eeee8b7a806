#pragma once
// How much of each pyramid level a pixel takes for a given d: weights fitted to the truth's own kernel, so
// that the surface-aware pyramid (SAP) reproduces the profile on a plane that faces the viewer.

#include "passes/common/profiles/shape.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace dermis::subsurface {

// A level l >= 1 is reached by l reductions with [1 3 3 1] / 8 and l bilinear expansions: its transfer
// function is the product of cos^6(pi f 2^k) over k < l and both axes. `smooth` filters every level with a
// 3x3 tent (cos^2(pi f 2^l)) first, which hides the grid's phase; `base` level 1 alone and takes the others
// as they are. Level 0 gives its centre and its tent in both. `half` is base without that tent and with a
// level 1 of plain 2x2 means (cos(pi f) in place of cos^3), for kernels that store no level 0. `plain` is the
// pyramid without surface: each level is read by the pixel itself through a cubic B-spline, level 0 as well
// (in place of the tent).
enum class SapVariant : uint8_t { base, smooth, half, plain };
inline constexpr uint32_t sap_variant_count = 4;

inline constexpr uint32_t sap_level_count = 9;                    // 0 to 8, spacing 1 to 256 px
inline constexpr uint32_t sap_weight_count = sap_level_count + 1; // centre, tent of level 0, levels 1 to 8
// The coarsest level that base, half or smooth filters with a tent.
constexpr uint32_t sap_last_tent(SapVariant variant) {
  return variant == SapVariant::smooth ? sap_level_count - 1 : 1;
}
inline constexpr uint32_t sap_nodes_per_octave = 4;
inline constexpr double sap_log2_d_first =
    -4.25; // d = .0526 px: just below the limit under which pixels are copied
inline constexpr uint32_t sap_node_count = 48; // up to d = 181 px

// The weights of one d. Non-negative; their sum is 1 within 1e-14.
using SapWeights = std::array<double, sap_weight_count>;

struct SapNode {
  double d_px = 0;
  SapWeights weights{};
  double residual = 0; // RMS of the transfer function's error under the fit's weight (sap_weights.cpp)
};

struct SapFit {
  SapVariant variant = SapVariant::smooth;
  std::array<SapNode, sap_node_count> nodes;
};

// Non-negative least squares at each node. Deterministic; tens of milliseconds. Thread: any.
SapFit fit_sap_weights(SapVariant variant);
// The same for another profile: `shape` in any unit, nodes by its d in pixels. The share of light that never
// scatters is part of the centre's weight.
SapFit fit_sap_weights(SapVariant variant, const ChannelShape& shape);
// Several variants in little more time than one: what they are fitted to is the same.
std::vector<SapFit> fit_sap_weights(std::span<const SapVariant> variants, const ChannelShape& shape);

// What a kernel needs of the weights, as shares of what is left at each level: out = mix(coarser, level l,
// t_l). centre and tent are level 0's weights; share[l] = W_l / sum of W_k over k >= l for l >= 1, share[8]
// = 1.
struct SapFractions {
  double centre = 1, tent = 0;
  std::array<double, sap_level_count> fraction{}; // share[0] unused
};
SapFractions sap_fractions(const SapWeights& weights);

// The device's table: sap_table_rows rows (centre, tent, share[1] to share[8]) of sap_node_count floats, so
// that a level reads one row only.
inline constexpr uint32_t sap_table_rows = sap_weight_count;
std::vector<float> make_sap_table(const SapFit& fit);

// Row `row` of the table at d px, linear in log2 d; below the first node everything but the centre fades
// linearly to 0 at d = 0; beyond the last node the last counts. shaders/sap/sap.glsl mirrors it.
template <class Real> Real sap_lookup(std::span<const float> table, uint32_t row, Real d_px);

} // namespace dermis::subsurface
