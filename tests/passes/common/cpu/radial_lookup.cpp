#include "tests/passes/common/cpu/radial_lookup.hpp"

#include "passes/common/profiles/burley_profile.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dermis::subsurface {

namespace {

struct Place {
  size_t low;
  float part; // 0 at `low`, 1 at the node above
};

Place place_at(float position) {
  const float clamped = std::clamp(position, 0.0f, static_cast<float>(radial_nodes - 1));
  const size_t low = std::min(static_cast<size_t>(clamped), size_t{radial_nodes} - 2);
  return {low, clamped - static_cast<float>(low)};
}

float radius_position(float d_mm, float r) {
  return (std::log2(std::max(r / d_mm, 1e-30f)) - static_cast<float>(radial_log2_r_first)) *
         static_cast<float>(radial_nodes_per_octave);
}

float mix(float a, float b, float part) {
  return a + part * (b - a);
}

} // namespace

std::array<float, 3> radial_falloff(std::span<const RadialRow> rows, float d_mm, float r) {
  const Place at = place_at(radius_position(d_mm, r));
  std::array<float, 3> result;
  for (size_t c = 0; c < 3; ++c)
    result[c] = std::exp2(mix(rows[at.low][c], rows[at.low + 1][c], at.part));
  return result;
}

std::array<float, 3> radial_survival(std::span<const RadialRow> rows, float d_mm, float r) {
  const float position = radius_position(d_mm, r);
  const Place at = place_at(position);
  std::array<float, 3> result;
  for (size_t c = 0; c < 3; ++c) {
    result[c] = mix(rows[radial_nodes + at.low][c], rows[radial_nodes + at.low + 1][c], at.part);
    // The kernel is flat below the first node, so that energy grows with the square of the radius.
    if (position < 0)
      result[c] = 1 - (1 - rows[radial_nodes][c]) *
                          std::exp2(2 * position / static_cast<float>(radial_nodes_per_octave));
  }
  return result;
}

RadialSample radial_sample(std::span<const RadialRow> rows, float u) {
  // u in (0, 1]; the root stays above 0, where its derivative is infinite and the radius is 0.
  const float fraction = std::clamp(u, static_cast<float>(burley_min_survival), 1.0f);
  const float root = std::sqrt(std::max(-std::log2(fraction), 1e-7f));
  const Place at = place_at(root * static_cast<float>(radial_inverse_nodes_per_unit));
  const float low = rows[at.low][3], high = rows[at.low + 1][3];
  // r is linear in the root q = sqrt(-log2 u): dr/du = dr/dq / (2 q u ln 2).
  const float slope = (high - low) * static_cast<float>(radial_inverse_nodes_per_unit);
  return {mix(low, high, at.part), 2 * root * fraction * std::numbers::ln2_v<float> / slope};
}

} // namespace dermis::subsurface
