#include "tests/passes/restir/triangle_scene.hpp"

#include <algorithm>
#include <numbers>

namespace dermis::restir::testing {

namespace {

constexpr double lift = 1e-6;      // Offset of ray origins from surfaces, in a scene of size 8.
constexpr uint32_t max_in_box = 4; // Triangles per leaf.
constexpr double view_half = 4;

const TriangleScene& scene_of(const void* of) {
  return *static_cast<const TriangleScene*>(of);
}

// Moeller & Trumbore 1997.
bool meets(const Triangle& t, const Vector3& origin, const Vector3& direction, double maximum,
           Hit& hit) {
  const Vector3 p = cross(direction, t.edge_2);
  const double determinant = dot(t.edge_1, p);
  if (determinant == 0) return false;
  const Vector3 from = origin - t.corner, q = cross(from, t.edge_1);
  const double u = dot(from, p) / determinant, v = dot(direction, q) / determinant;
  const double distance = dot(t.edge_2, q) / determinant;
  if (u < 0 || v < 0 || u + v > 1 || !(distance > 0) || !(distance < maximum)) return false;
  hit.distance = distance;
  hit.barycentrics = {u, v};
  return true;
}

bool meets(const BoxNode& box, const Vector3& origin, const Vector3& inverse, double maximum) {
  double near = 0, far = maximum;
  for (size_t i = 0; i < 3; ++i) {
    const double a = (box.low[i] - origin[i]) * inverse[i],
                 b = (box.high[i] - origin[i]) * inverse[i];
    near = std::max(near, std::min(a, b)); // 0 * inf is NaN, which min and max skip here.
    far = std::min(far, std::max(a, b));
  }
  return near <= far;
}

// Calls found(hit) for each hit within `maximum`, which `found` may reduce; stops if it returns
// false.
template <class Found>
void for_hits(const TriangleScene& scene, const Vector3& origin, const Vector3& direction,
              double& maximum, Found&& found) {
  const Vector3 inverse = {1 / direction[0], 1 / direction[1], 1 / direction[2]};
  uint32_t stack[64], depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const BoxNode& box = scene.boxes[stack[--depth]];
    if (!meets(box, origin, inverse, maximum)) continue;
    if (box.count == 0) {
      stack[depth++] = box.first;
      stack[depth++] = box.first + 1;
      continue;
    }
    for (uint32_t i = box.first; i < box.first + box.count; ++i) {
      Hit hit;
      hit.triangle = i;
      if (meets(scene.triangles[i], origin, direction, maximum, hit) && !found(hit)) return;
    }
  }
}

void trace_probe(const void* of, const ProbeRay& ray, uint32_t medium, ProbeHits& hits) {
  const TriangleScene& scene = scene_of(of);
  hits.count = 0;
  double maximum = ray.length;
  for_hits(scene, ray.origin, ray.direction, maximum, [&](const Hit& hit) {
    const Triangle& t = scene.triangles[hit.triangle];
    if (t.medium != medium) return true;
    // Inserts in order and drops the furthest hit.
    uint32_t at = std::min(hits.count, max_probe_hits - 1);
    if (hits.count == max_probe_hits && hits.hit[at].distance <= hit.distance) return true;
    for (; at > 0 && hits.hit[at - 1].distance > hit.distance; --at)
      hits.hit[at] = hits.hit[at - 1];
    hits.hit[at] = {t.instance, t.primitive, hit.barycentrics, hit.distance};
    hits.count = std::min(hits.count + 1, max_probe_hits);
    return true;
  });
}

SurfacePoint surface_at(const void* of, uint32_t instance, uint32_t primitive,
                        const Barycentrics& b) {
  const TriangleScene& scene = scene_of(of);
  const Triangle& t = scene.triangles[scene.rows[instance - first_instance][primitive]];
  return {t.corner + b[0] * t.edge_1 + b[1] * t.edge_2, t.normal, t.normal, t.medium};
}

bool visible(const void* of, const SurfacePoint& from, const Vector3& target) {
  const Vector3 origin = from.position + lift * from.normal, way = target - origin;
  const double distance = length(way);
  double maximum = distance - lift;
  bool is_free = true;
  for_hits(scene_of(of), origin, 1 / distance * way, maximum,
           [&](const Hit&) { return is_free = false; });
  return is_free;
}

void split(TriangleScene& scene, uint32_t node, uint32_t first, uint32_t count) {
  BoxNode box;
  box.low = {1e30, 1e30, 1e30};
  box.high = {-1e30, -1e30, -1e30};
  for (uint32_t i = first; i < first + count; ++i) {
    const Triangle& t = scene.triangles[i];
    for (const Vector3& p : {t.corner, t.corner + t.edge_1, t.corner + t.edge_2})
      for (size_t k = 0; k < 3; ++k) {
        box.low[k] = std::min(box.low[k], p[k] - lift);
        box.high[k] = std::max(box.high[k], p[k] + lift);
      }
  }
  const Vector3 size = box.high - box.low;
  const size_t axis =
      static_cast<size_t>(std::max_element(size.begin(), size.end()) - size.begin());
  box.first = first;
  box.count = count;
  if (count > max_in_box) {
    const auto middle = [&](const Triangle& t) {
      return 3 * t.corner[axis] + t.edge_1[axis] + t.edge_2[axis];
    };
    const auto begin = scene.triangles.begin() + first;
    std::nth_element(begin, begin + count / 2, begin + count,
                     [&](const Triangle& a, const Triangle& b) { return middle(a) < middle(b); });
    box.first = static_cast<uint32_t>(scene.boxes.size());
    box.count = 0;
    scene.boxes.resize(scene.boxes.size() + 2);
    split(scene, box.first, first, count / 2);
    split(scene, box.first + 1, first + count / 2, count - count / 2);
  }
  scene.boxes[node] = box;
}

using Corners = std::vector<Vector3>;

// Adds four corners, counterclockwise from outside.
void add_quad(Corners& corners, const Vector3& a, const Vector3& b, const Vector3& c,
              const Vector3& d) {
  for (const Vector3& p : {a, b, c, a, c, d})
    corners.push_back(p);
}

Corners sphere(const Vector3& centre, double radius, int rings) {
  Corners corners;
  const auto point = [&](int ring, int step) {
    const double theta = std::numbers::pi * ring / rings, phi = std::numbers::pi * step / rings;
    return centre + radius * Vector3{std::sin(theta) * std::cos(phi),
                                     std::sin(theta) * std::sin(phi), std::cos(theta)};
  };
  for (int i = 0; i < rings; ++i)
    for (int j = 0; j < 2 * rings; ++j)
      if (i == 0)
        corners.insert(corners.end(), {point(0, j), point(1, j), point(1, j + 1)});
      else if (i == rings - 1)
        corners.insert(corners.end(), {point(i, j), point(rings, j), point(i, j + 1)});
      else
        add_quad(corners, point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1));
  return corners;
}

// Maps the surface of the unit cube: all six sides in n x n pieces.
template <class Map> Corners cube(int n, Map&& map) {
  Corners corners;
  for (size_t axis = 0; axis < 3; ++axis)
    for (const double side : {0.0, 1.0})
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
          const auto point = [&](int a, int b) {
            Vector3 p{};
            p[axis] = side;
            p[(axis + 1) % 3] = double(a) / n;
            p[(axis + 2) % 3] = double(b) / n;
            return map(p);
          };
          if (side > 0)
            add_quad(corners, point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1));
          else
            add_quad(corners, point(i, j), point(i, j + 1), point(i + 1, j + 1), point(i + 1, j));
        }
  return corners;
}

} // namespace

Scene TriangleScene::access() const {
  return {this, trace_probe, surface_at, visible, lights};
}

void add_instance(TriangleScene& scene, uint32_t medium, const std::vector<Vector3>& corners) {
  const uint32_t instance = first_instance + static_cast<uint32_t>(scene.rows.size());
  const size_t count = corners.size() / 3;
  scene.rows.emplace_back(count);
  for (size_t i = 0; i < count; ++i) {
    Triangle t;
    t.corner = corners[3 * i];
    t.edge_1 = corners[3 * i + 1] - t.corner;
    t.edge_2 = corners[3 * i + 2] - t.corner;
    const Vector3 across = cross(t.edge_1, t.edge_2);
    t.area = length(across) / 2;
    t.normal = normalize(across);
    t.instance = instance;
    t.primitive = static_cast<uint32_t>(i);
    t.medium = medium;
    scene.triangles.push_back(t);
  }
}

void finish(TriangleScene& scene) {
  scene.boxes.assign(1, {});
  split(scene, 0, 0, static_cast<uint32_t>(scene.triangles.size()));
  for (uint32_t i = 0; i < scene.triangles.size(); ++i)
    scene.rows[scene.triangles[i].instance - first_instance][scene.triangles[i].primitive] = i;
  share_lights(scene.lights);
}

bool nearest_hit(const TriangleScene& scene, const Vector3& origin, const Vector3& direction,
                 double maximum, Hit& hit) {
  bool found = false;
  for_hits(scene, origin, direction, maximum, [&](const Hit& one) {
    hit = one;
    maximum = one.distance;
    return found = true;
  });
  return found;
}

TriangleScene ear_scene() {
  TriangleScene scene;
  scene.d = {{}, {0.6, 0.4, 0.25}, {0.8, 0.4, 0}};
  add_instance(scene, 1, sphere({-1.6, 1.2, 0}, 1.7, 12));
  add_instance(scene, 1, cube(2, [](const Vector3& p) {
                 return Vector3{-3.6 + 5.4 * p[0], -2.6 + 1.6 * p[1], -1.5 + 2 * p[2]};
               }));
  // A sheet 0.2 thick, bent about an upright axis in front of it.
  add_instance(scene, 2, cube(6, [](const Vector3& p) {
                 const double turn = 1.6 * (p[0] - 0.5), radius = 1.6 + 0.2 * (1 - p[2]);
                 return Vector3{2.1 + radius * std::sin(turn), -2.2 + 4.6 * p[1],
                                1.5 - radius * std::cos(turn)};
               }));
  Light behind;
  behind.position = {2.6, 0.6, -3};
  behind.emission = {12, 10, 8};
  Light above;
  above.type = LightType::parallelogram;
  above.position = {-5, 3, 4};
  above.edge_u = {1, 2, 0};
  above.edge_v = {1.5, 0, 1.5};
  above.emission = {16, 18, 20};
  const Vector3 to_middle = -above.position;
  if (dot(cross(above.edge_u, above.edge_v), to_middle) < 0) std::swap(above.edge_u, above.edge_v);
  scene.lights = {behind, above};
  finish(scene);
  return scene;
}

double pixel_footprint(uint32_t width) {
  return 2 * view_half / width;
}

std::vector<Pixel> look_at(const TriangleScene& scene, uint32_t width, uint32_t height,
                           double shift) {
  std::vector<Pixel> pixels(size_t{width} * height);
  const Scene access = scene.access();
  const double step = pixel_footprint(width);
  for (uint32_t y = 0; y < height; ++y)
    for (uint32_t x = 0; x < width; ++x) {
      Hit hit;
      const Vector3 origin = {-view_half + step * (x + 0.5 + shift), view_half - step * (y + 0.5),
                              10};
      if (!nearest_hit(scene, origin, {0, 0, -1}, 100, hit)) continue;
      const Triangle& t = scene.triangles[hit.triangle];
      const SurfacePoint x1 = surface_at(&scene, t.instance, t.primitive, hit.barycentrics);
      Pixel& pixel = pixels[size_t{y} * width + x];
      pixel.domain = {x1.position, x1.normal, scene.d[t.medium], t.medium};
      pixel.instance = t.instance - first_instance;
      constexpr uint32_t middle = 0x80008000u; // The middle of a light.
      for (const Light& light : scene.lights)
        pixel.lit =
            pixel.lit ||
            (luminance(light_irradiance(light, middle, x1.position, x1.normal, x1.shading)) > 0 &&
             access.visible(access.of, x1, light_target(light, middle, x1.position)));
    }
  return pixels;
}

} // namespace dermis::restir::testing
