#pragma once
// Lights and next-event estimation: picks a light and a place on the light, and returns the
// irradiance. Measures are area of the light's surface (area lights) or one point (others).
// shaders/restir/lights.glsl mirrors these functions under the same names. Pure; thread: any.

#include "tests/passes/restir/cpu/vector.hpp"

#include <cstdint>
#include <span>

namespace dermis::restir {

enum class LightType : uint32_t { point, parallelogram, triangle, directional };

// Occupies 64 bytes on a device (lights.glsl).
struct Light {
  // Point: position; area: a corner; directional: unit vector towards the light.
  Vector3 position{};
  LightType type = LightType::point;
  // Area: edges from the corner; the light shines to the side of cross(edge_u, edge_v).
  Vector3 edge_u{};
  double fraction = 1; // Probability of being picked; the probabilities of all lights sum to 1.
  Vector3 edge_v{};
  double area = 1; // Area: surface area; directional: length of shadow rays; point: 1.
  // Point: intensity; area: radiance; directional: irradiance on a plane that faces the light.
  Vector3 emission{};
  double until = 1; // Sum of the probabilities up to and including this light.
};

// Sets area, fraction and until. Fractions follow emitted power; directional lights count as the
// sum of all others, or 1. Works on any list, also empty or dark.
void share_lights(std::span<Light> lights);

// Packs a place on a light into two numbers of 16 bits, so that it stays exact wherever it is
// stored.
uint32_t light_place(double u, double v);
// Returns the first light whose `until` is above u, or the last light.
uint32_t pick_light(std::span<const Light> lights, double u);
// Returns the density of picking this light and place; for area lights per unit of area.
double light_density(const Light& light);
// Returns the end of shadow rays from `from`.
Vector3 light_target(const Light& light, uint32_t place, const Vector3& from);
// Returns the irradiance at a surface from this place of the light without occlusion; for area
// lights per unit of area. `normal` is the geometric normal, `shading` the shading normal; light
// from behind either normal gives 0.
Vector3 light_irradiance(const Light& light, uint32_t place, const Vector3& position,
                         const Vector3& normal, const Vector3& shading);

} // namespace dermis::restir
