#include "tests/passes/restir/cpu/lights.hpp"

#include <algorithm>
#include <numbers>

namespace dermis::restir {

namespace {

bool has_area(const Light& light) {
  return light.type == LightType::parallelogram || light.type == LightType::triangle;
}

} // namespace

void share_lights(std::span<Light> lights) {
  double local = 0;
  for (Light& light : lights) {
    light.fraction = 0;
    if (has_area(light)) {
      light.area = length(cross(light.edge_u, light.edge_v)) *
                   (light.type == LightType::triangle ? 0.5 : 1.0);
      // A diffuse light with one side.
      light.fraction = std::numbers::pi * light.area * luminance(light.emission);
    } else if (light.type == LightType::point) {
      light.area = 1;
      light.fraction = 4 * std::numbers::pi * luminance(light.emission);
    }
    local += light.fraction;
  }
  double sum = 0;
  for (Light& light : lights) {
    if (light.type == LightType::directional && luminance(light.emission) > 0)
      light.fraction = local > 0 ? local : 1;
    sum += light.fraction;
  }
  double until = 0;
  for (Light& light : lights) {
    light.fraction = sum > 0 ? light.fraction / sum : 1.0 / double(lights.size());
    light.until = until += light.fraction;
  }
}

uint32_t light_place(double u, double v) {
  const auto cell = [](double x) {
    return std::min(static_cast<uint32_t>(std::max(x, 0.0) * 65536), 65535u);
  };
  return cell(u) | cell(v) << 16;
}

uint32_t pick_light(std::span<const Light> lights, double u) {
  uint32_t i = 0;
  while (i + 1 < lights.size() && !(u < lights[i].until))
    ++i;
  return i;
}

double light_density(const Light& light) {
  return has_area(light) ? light.fraction / light.area : light.fraction;
}

Vector3 light_target(const Light& light, uint32_t place, const Vector3& from) {
  if (light.type == LightType::point) return light.position;
  if (light.type == LightType::directional) return from + light.area * light.position;
  double u = ((place & 0xffffu) + 0.5) / 65536, v = ((place >> 16) + 0.5) / 65536;
  // Mirrors the other half of the parallelogram onto the triangle.
  if (light.type == LightType::triangle && u + v > 1) {
    u = 1 - u;
    v = 1 - v;
  }
  return light.position + u * light.edge_u + v * light.edge_v;
}

Vector3 light_irradiance(const Light& light, uint32_t place, const Vector3& position,
                         const Vector3& normal, const Vector3& shading) {
  const Vector3 way = light_target(light, place, position) - position;
  const double square = dot(way, way);
  if (!(square > 0)) return {};
  const Vector3 direction = 1 / std::sqrt(square) * way;
  const double cosine = dot(direction, shading);
  if (!(cosine > 0) || !(dot(direction, normal) > 0)) return {};
  if (light.type == LightType::directional) return cosine * light.emission;
  double factor = cosine / square;
  if (has_area(light)) {
    const double out = -dot(direction, normalize(cross(light.edge_u, light.edge_v)));
    if (!(out > 0)) return {};
    factor *= out;
  }
  return factor * light.emission;
}

} // namespace dermis::restir
