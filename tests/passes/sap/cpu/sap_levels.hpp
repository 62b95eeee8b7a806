#pragma once
// The levels of the surface-aware pyramid on the CPU: light, surface and mass, from the view down
// to one texel per 256 pixels.

#include "passes/common/reference/reference.hpp"
#include "passes/sap/sap_weights.hpp"

#include <array>
#include <cmath>

namespace dermis::subsurface {

// Standard deviation of [1 3 3 1] in its own spacings: sqrt(3)/2.
inline constexpr double sap_sigma = 0.8660254;
// Widths of the weights in sigmas, measured on a scanned head, a bust and generated scenes
// (docs/techniques.md).
// Distance from the tangent plane: stops at depth steps.
inline constexpr double sap_depth_width = 2;
// The same on the way up, if texels of the finer level are farther apart than that, in pixels. Much
// of the light of coarse levels comes from still coarser ones, whose kernels are wider. Wider from
// level 0 on, low steps and narrow grooves get worse.
inline constexpr double sap_depth_width_up = 2.1, sap_first_wide_spacing = 2.5;
// Depth along the tangent plane: narrows the kernel on slopes. 1 makes the downward pass a Gaussian
// of distance in space; the upward pass narrows nothing.
inline constexpr double sap_tilt_width_down = 1;
inline constexpr double sap_tilt_width_tent = 1.25;
// Width of the distance from the further of two tangent planes, used for the confidence: best
// separates exact from inexact pixels on the framings of the scanned head and the bust.
inline constexpr double sap_confidence_width = 0.87;
// Distance in d from which a surface does not matter to a texel; nearer ones matter linearly.
inline constexpr double sap_relevant_d = 6;
// Powers of the cosine to the viewer.
// - A texel is weighted by the fourth root of its area: a tilted surface has more area but is also
//   further off, which tangent planes capture only partly.
// - d shrinks with the eighth root, and with the fourth root for level 0's own fractions, since a
//   tilted pixel keeps more of its light.
inline constexpr double sap_area_power = 0.25, sap_reach_power = 0.125;
// A folded surface has more area within reach than its mean plane: where children can have two
// layers, mass counts their area over that of the parent, to a power measured on the scenes of the
// family. 255 / sap_max_mass is a whole number, so that a byte of the kernels holds a mass of 1.
inline constexpr double sap_first_area_spacing = 2; // of the children, in pixels
inline constexpr double sap_max_mass = 1.875, sap_max_area = 2.5, sap_gain_power = 1.65;
// Children whose rise along the slope of their planes is less than 1 / sap_rising of the planes'
// are on teeth of a saw, measured on the scales of the family.
inline constexpr double sap_rising = 16;
// Change of depth per pixel, in sides of a pixel, beyond which a pixel is next to another surface.
// Such steps, of 3.5 sigmas, leave enough of a child for the seed of a second layer.
inline constexpr double sap_edge_slope = 3;
inline constexpr double sap_negligible = 1e-12;

template <class Real> Real sap_falloff(Real x, double width) {
  return std::exp(x * x * Real(-0.5 / (width * width)));
}
// Returns the distance that is nearer to 0. A texel is off the surface by the smaller of its
// distances from the tangent plane and in depth, because across a fold the plane leaves a nearby
// surface.
template <class Real> Real sap_nearer(Real a, Real b) {
  return std::min(std::abs(a), std::abs(b));
}

// Returns how much a surface matters to a texel at a distance from it.
template <class Real> Real sap_relevance(Real distance, Real d) {
  return std::max(1 - std::abs(distance) / (Real(sap_relevant_d) * std::max(d, Real(1e-9))),
                  Real(0));
}

template <class Real> struct SapTexel {
  Real depth = 0;                // Metres.
  Real slope_x = 0, slope_y = 0; // Change of depth per pixel, in footprints.
  Real reach = 0;                // Factor on d: cos^(1/8) to the viewer times the scatter scale.
  Real mass = 0;                 // Fraction of the texel's own kernel that met the surface.
  Real area = 0;                 // Fourth root of the surface's area over its cross-section.
  bool at_edge = false;          // Level 0: next to another surface.
  std::array<Real, 3> light{};
  uint8_t id = 0; // Profile; 0: no surface.
  // Fraction of the surface of this profile under the texel that one of its layers represents, or
  // that is too far off to matter at the profile's d.
  Real held = 1;
  Real lost = 0; // Fraction of the surface under the texel whose profile no layer has.

  Real slope(Real x, Real y) const { return slope_x * x + slope_y * y; }
  // Returns the area of a surface over its cross-section that has `part` of the slope.
  Real slope_area(Real part = 1) const {
    return std::min(std::sqrt(1 + part * part * (slope_x * slope_x + slope_y * slope_y)),
                    Real(sap_max_area));
  }
};

// Level 0 has the view's texels; other levels have a border of one texel for the pixels beyond the
// last whole texel.
template <class Real> struct SapLevel {
  int width = 0, height = 0, border = 0; // Texels.
  Real spacing = 1;                      // Pixels; geometric mean of both axes.
  Real spacing_x = 1, spacing_y = 1;     // Pixels.
  // The first layer is the surface with the most weight in the texel. The second layer is the rest,
  // empty in levels with one layer.
  std::array<std::vector<SapTexel<Real>>, 2> layers{};

  size_t index(int x, int y) const {
    return static_cast<size_t>(y + border) * static_cast<size_t>(width + 2 * border) +
           static_cast<size_t>(x + border);
  }
  // Returns the texel of a layer if the position is inside and it has a surface, else null.
  const SapTexel<Real>* find(size_t layer, int x, int y) const {
    if (x < -border || y < -border || x >= width + border || y >= height + border) return nullptr;
    if (layers[layer].empty()) return nullptr;
    const SapTexel<Real>& texel = layers[layer][index(x, y)];
    return texel.id != 0 ? &texel : nullptr;
  }
  // As find(), if the profile is `id`.
  const SapTexel<Real>* find(size_t layer, int x, int y, uint8_t id) const {
    const SapTexel<Real>* texel = find(layer, x, y);
    return texel != nullptr && texel->id == id ? texel : nullptr;
  }
};

// The first levels halve one axis only.
struct SapGrid {
  SapShape shape{};
  bool flipped = false; // x of the shape is y of the view
  uint32_t axis(uint32_t of_view) const { return flipped ? 1 - of_view : of_view; }
  bool halves(uint32_t of_view, size_t level) const {
    return shape.halves(axis(of_view), uint32_t(level));
  }
  double spacing(uint32_t of_view, size_t level) const {
    return shape.spacing(axis(of_view), uint32_t(level));
  }
};

template <class Real> struct SapPyramid {
  Real side_x = 1, side_y = 1; // Sides of a pixel in metres (at depth 1 m if perspective).
  bool perspective = false;
  SapGrid grid{};
  std::vector<SapLevel<Real>> levels{};

  // Return the geometric mean of a pixel's sides at a depth, and its smaller side, in metres.
  Real footprint(Real depth) const {
    return std::sqrt(side_x * side_y) * (perspective ? depth : Real(1));
  }
  Real smallest_side(Real depth) const {
    return std::min(side_x, side_y) * (perspective ? depth : Real(1));
  }
  // Returns the rise of a texel's tangent plane at an offset in pixels, in metres.
  Real rise(const SapTexel<Real>& texel, Real x, Real y) const {
    return texel.slope(x, y) * footprint(texel.depth);
  }
};

// Builds all levels; levels from `first_layered` (1 or more) have two layers per texel. At level 1,
// only texels with a child at an edge can have a second layer.
// Deterministic for any number of threads. Real: float or double.
template <class Real>
SapPyramid<Real> build_sap_pyramid(const ReferenceInput& input, uint32_t first_layered,
                                   unsigned threads, SapGrid grid = {});

} // namespace dermis::subsurface
