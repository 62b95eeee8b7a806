// The mass of texels on folded surfaces, on the way down. A folded surface has more area within
// reach than its mean plane.
#ifndef DERMIS_SAP_FOLDS_GLSL
#define DERMIS_SAP_FOLDS_GLSL

#include "sap/sap.glsl"

// See tests/passes/sap/cpu/sap_levels.hpp.
const float sap_rising = 16.0, sap_max_area = 2.5, sap_gain_power = 1.65;
const float sap_first_area_spacing = 2.0;

// Returns the area of a surface divided by its cross-section, at most sap_max_area.
float sap_area_of(vec2 slope) { return min(sqrt(1.0 + dot(slope, slope)), sap_max_area); }

// Returns the mass of a parent by the area of its children, up to sap_max_mass.
// - Without a gain of area, mass is at most that of the children: on a bend they are nearer than
//   the plane of the seed, but the surface is not larger.
// - The gain is a power of the ratio of areas, because folds also lose mass on the way up.
// - On a sawtooth surface, the depths of the children do not follow the slopes of their planes. The
//   parent then has the area of the surface along which the children lie.
// - There is no gain where surface ends. A sphere has no more area within reach than a plane, and
//   bends most where the coarse levels reach its rim.
// Sums over the children near the seed's plane:
// - mass;
// - area_mass: mass times area;
// - rise: mass times the rise of the child and that of the seed's plane, in sigmas.
// first: weight times mass of the first layer of all children. all_weight: sum of `mass` if all
// children are on the seed's plane. slope: of the parent.
float sap_mass_by_area(float mass, float area_mass, float rise, float first, float all_weight,
                       vec2 seed_slope, vec2 slope) {
  // The mean square of a plane's rise in sigmas is the square of its slope.
  float plane = max(mass * dot(seed_slope, seed_slope), sap_negligible);
  float rising = clamp(sap_rising * rise / plane, 0.0, 1.0);
  float ratio = area_mass / (mass * sap_area_of(rising * slope));
  float covered = min(first * first, 1.0);
  covered *= covered;
  float gain = 1.0 + (pow(ratio, sap_gain_power) - 1.0) * covered * covered;
  return min(min(mass / all_weight, max(first, 1.0)) * gain, sap_max_mass);
}

#endif
