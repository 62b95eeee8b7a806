#pragma once
// The levels of the surface-aware pyramid on the CPU: light, surface and mass, from the view down to one
// texel every 256 pixels.

#include "passes/common/reference/reference.hpp"
#include "passes/sap/sap_weights.hpp"

#include <array>
#include <cmath>

namespace dermis::subsurface {

inline constexpr double sap_sigma = 0.8660254; // of [1 3 3 1] in its own spacings: sqrt(3)/2
// Widths of the weights in sigmas, measured on a scanned head, a bust and generated scenes
// (docs/techniques.md).
inline constexpr double sap_depth_width = 2; // distance from the tangent plane: stops at depth steps
// Depth along the tangent plane: narrows the kernel on slopes. 1 makes the way down a Gaussian of distance in
// space; on the way up nothing is narrowed.
inline constexpr double sap_tilt_width_down = 1;
inline constexpr double sap_tilt_width_tent = 1.25;
// Width of the distance from the further of two tangent planes, where confidence is counted: what parts exact
// pixels from others on the scanned head's and the bust's framings.
inline constexpr double sap_confidence_width = 0.87;
// Powers of the cosine to the viewer. A texel counts with its area's fourth root: a surface that turns away
// has more area and is as much further off, which tangent planes see in part. d shrinks with the eighth root,
// and with the fourth where level 0's own shares are concerned, since a tilted pixel keeps more of its light.
inline constexpr double sap_area_power = 0.25, sap_reach_power = 0.125;
inline constexpr double sap_negligible = 1e-12;

template <class Real> Real sap_falloff(Real x, double width) {
  return std::exp(x * x * Real(-0.5 / (width * width)));
}
// Of two distances the one nearer to 0. A texel counts as off the surface by its distance from the tangent
// plane or by its distance in depth, whichever is less: across a fold the plane leaves a surface that is
// near.
template <class Real> Real sap_nearer(Real a, Real b) {
  return std::min(std::abs(a), std::abs(b));
}

template <class Real> struct SapTexel {
  Real depth = 0;                // metres
  Real slope_x = 0, slope_y = 0; // change of depth from pixel to pixel, in footprints
  Real reach = 0;                // factor on d: cos^(1/8) to the viewer times the scatter scale
  Real mass = 0;                 // share of the texel's own kernel that met the surface
  Real area = 0;                 // fourth root of the surface's area over its cross-section
  std::array<Real, 3> light{};
  uint8_t id = 0; // profile, 0: nothing here

  Real slope(Real x, Real y) const { return slope_x * x + slope_y * y; }
};

// Level 0 has the view's texels; others have a border of one texel, which takes what lies beyond the last
// pixels.
template <class Real> struct SapLevel {
  int width = 0, height = 0, border = 0; // texels
  Real spacing = 1;                      // pixels
  // The surface that most of what a texel stands for lies on and, of levels with two layers, what lies off
  // it: empty with one layer.
  std::array<std::vector<SapTexel<Real>>, 2> layers{};

  size_t index(int x, int y) const {
    return static_cast<size_t>(y + border) * static_cast<size_t>(width + 2 * border) +
           static_cast<size_t>(x + border);
  }
  // The texel of a layer if it is inside and of profile `id`, else null.
  const SapTexel<Real>* find(size_t layer, int x, int y, uint8_t id) const {
    if (x < -border || y < -border || x >= width + border || y >= height + border) return nullptr;
    if (layers[layer].empty()) return nullptr;
    const SapTexel<Real>& texel = layers[layer][index(x, y)];
    return texel.id == id && id != 0 ? &texel : nullptr;
  }
};

template <class Real> struct SapPyramid {
  Real side_x = 1, side_y = 1; // of a pixel, metres (at depth 1 m if perspective)
  bool perspective = false;
  std::vector<SapLevel<Real>> levels{};

  // Geometric mean of a pixel's sides at a depth; its smaller side; metres.
  Real footprint(Real depth) const { return std::sqrt(side_x * side_y) * (perspective ? depth : Real(1)); }
  Real smallest_side(Real depth) const { return std::min(side_x, side_y) * (perspective ? depth : Real(1)); }
  // Rise of a texel's tangent plane at an offset in pixels, metres.
  Real rise(const SapTexel<Real>& texel, Real x, Real y) const {
    return texel.slope(x, y) * footprint(texel.depth);
  }
};

// All levels, those from `first_layered` on (1 or more) with two layers a texel. Deterministic for any number
// of threads. Real: float or double.
template <class Real>
SapPyramid<Real> build_sap_pyramid(const ReferenceInput& input, uint32_t first_layered, unsigned threads);

} // namespace dermis::subsurface
