#pragma once
// Lights and next-event estimation: which light, where on it, how much arrives. Measures are area of the
// light's surface (areas) or one point (others). shaders/restir/lights.glsl mirrors these functions
// under the same names. Pure; thread: any.

#include "tests/passes/restir/cpu/vector.hpp"

#include <cstdint>
#include <span>

namespace dermis::restir {

enum class LightType : uint32_t { point, parallelogram, triangle, directional };

// 64 bytes on a device (lights.glsl).
struct Light {
  Vector3 position{}; // point: where it is; areas: a corner; directional: unit vector towards the light
  LightType type = LightType::point;
  Vector3 edge_u{};    // areas: edges from the corner; the light shines where cross(edge_u, edge_v) points
  double fraction = 1; // probability of being picked; those of all lights sum to 1
  Vector3 edge_v{};
  double area = 1;    // areas: theirs; directional: how far away its shadow rays end; point: 1
  Vector3 emission{}; // point: intensity; areas: radiance; directional: irradiance on a plane that faces it
  double until = 1;   // sum of the shares up to this light, itself included
};

// Sets area, share and until: shares follow emitted power (directional lights count as the sum of all others,
// or 1). Any list, also empty or dark.
void share_lights(std::span<Light> lights);

// A place on a light as two numbers of 16 bits each, so that it is the same wherever it is stored.
uint32_t light_place(double u, double v);
// The first whose `until` lies above u; the last where none does.
uint32_t pick_light(std::span<const Light> lights, double u);
// Of picking this light and this place: per area of areas.
double light_density(const Light& light);
// Where shadow rays from `from` end.
Vector3 light_target(const Light& light, uint32_t place, const Vector3& from);
// Irradiance at a surface from this place of the light, per area of areas, as if nothing stood between.
// `normal` is the geometric, `shading` the shading normal: none falls in from behind either.
Vector3 light_irradiance(const Light& light, uint32_t place, const Vector3& position, const Vector3& normal,
                         const Vector3& shading);

} // namespace dermis::restir
