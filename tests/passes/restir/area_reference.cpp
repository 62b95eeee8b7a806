#include "tests/passes/restir/area_reference.hpp"

#include "passes/common/reference/parallel.hpp"
#include "tests/passes/restir/cpu/random.hpp"

#include <algorithm>
#include <map>

namespace dermis::restir::testing {

namespace {

struct LitPoint {
  Vector3 position{}, light{}; // `light` is irradiance over the density of the sample.
};

// Samples triangles by area and all lights equally often, unlike restir::pick_light.
std::vector<LitPoint> draw_points(const TriangleScene& scene, uint32_t medium, uint32_t points,
                                  Random& random) {
  std::vector<double> until;
  double area = 0;
  for (const Triangle& t : scene.triangles)
    until.push_back(area += t.medium == medium ? t.area : 0);
  const Scene access = scene.access();
  std::vector<LitPoint> result;
  for (uint32_t i = 0; i < points; ++i) {
    const auto at =
        std::upper_bound(until.begin(), until.end(), random_unit(random) * area) - until.begin();
    const Triangle& t = scene.triangles[std::min(static_cast<size_t>(at), until.size() - 1)];
    double u = random_unit(random), v = random_unit(random);
    if (u + v > 1) {
      u = 1 - u;
      v = 1 - v;
    }
    const SurfacePoint x2 = {t.corner + u * t.edge_1 + v * t.edge_2, t.normal, t.normal, t.medium};
    const size_t which = static_cast<size_t>(random_unit(random) * double(scene.lights.size()));
    const Light& light = scene.lights[which];
    const Vector3 x3 = light.type == LightType::point
                           ? light.position
                           : light.position + random_unit(random) * light.edge_u +
                                 random_unit(random) * light.edge_v;
    const Vector3 way = x3 - x2.position, direction = normalize(way);
    double factor = dot(direction, t.normal) / dot(way, way);
    if (light.type == LightType::parallelogram)
      factor *=
          // The product contains the area.
          std::max(0.0, -dot(direction, cross(light.edge_u, light.edge_v)));
    if (!(factor > 0) || !access.visible(access.of, x2, x3)) continue;
    result.push_back(
        {x2.position, factor * area * double(scene.lights.size()) / points * light.emission});
  }
  return result;
}

} // namespace

Regions regions_of(const std::vector<Pixel>& pixels) {
  std::map<std::pair<uint32_t, bool>, std::vector<uint32_t>> found;
  for (uint32_t i = 0; i < pixels.size(); ++i)
    if (pixels[i].domain.medium != 0) found[{pixels[i].instance, pixels[i].lit}].push_back(i);
  Regions regions;
  std::vector<uint32_t> all;
  for (auto& [key, region] : found)
    all.insert(all.end(), region.begin(), region.end());
  for (auto& [key, region] : found)
    if (region.size() >= min_pixels) regions.pixels.push_back(std::move(region));
  regions.pixels.push_back(std::move(all));
  return regions;
}

std::vector<std::vector<double>> area_reference(const TriangleScene& scene,
                                                const std::vector<Pixel>& pixels,
                                                const Regions& regions, uint32_t batches,
                                                uint32_t points, uint32_t seed) {
  std::vector<std::vector<double>> means(regions.pixels.size(), std::vector<double>(batches));
  subsurface::parallel_for(batches, 1, 0, [&](size_t batch) {
    std::vector<std::vector<LitPoint>> lit(scene.d.size());
    for (uint32_t medium = 1; medium < lit.size(); ++medium) {
      Random random{static_cast<uint32_t>(batch), seed, medium << 28};
      lit[medium] = draw_points(scene, medium, points, random);
    }
    for (size_t r = 0; r < regions.pixels.size(); ++r) {
      double sum = 0;
      for (const uint32_t pixel : regions.pixels[r]) {
        const Domain& domain = pixels[pixel].domain;
        for (const LitPoint& point : lit[domain.medium])
          sum +=
              luminance(scattered(domain, length(point.position - domain.position), point.light));
      }
      means[r][batch] = sum / double(regions.pixels[r].size());
    }
  });
  return means;
}

} // namespace dermis::restir::testing
