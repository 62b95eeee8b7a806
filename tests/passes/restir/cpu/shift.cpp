#include "tests/passes/restir/cpu/shift.hpp"

#include <algorithm>

namespace dermis::restir {

namespace {

// Surfaces whose normals have at least this cosine may belong to one sheet. Points this many d
// apart count as connected through the body (KIT's implementation).
constexpr double connectable_cosine = 0.5, connectable_distance_in_d = 2;

SurfacePoint surface_of(const Scene& scene, const Reservoir& path) {
  return scene.surface_at(scene.of, path.instance, path.primitive, path.barycentrics);
}

bool replays(Shift shift, const Domain& domain, const SurfacePoint& x2) {
  return shift == Shift::delayed ||
         (shift == Shift::hybrid && !connectable(domain, x2.position, x2.normal));
}

Shifted reconnect(const Domain& to, const SurfacePoint& x2, const Reservoir& path) {
  Shifted result{path, 1, 0};
  result.path.hits = 0;
  result.target = luminance(scattered(to, length(x2.position - to.position), path.irradiance));
  return result;
}

Shifted replay(const Scene& scene, Shift shift, const Domain& to, const Reservoir& path) {
  Shifted result{path, 0, 0};
  if (path.hits == 0) return result;
  ProbeHits hits;
  scene.trace_probe(scene.of, probe_of(to, path.numbers), to.medium, hits);
  if (hits.count == 0) return result;
  const ProbeHit& hit = hits.hit[picked_hit(path.numbers.pick, hits.count)];
  const SurfacePoint y2 = scene.surface_at(scene.of, hit.instance, hit.primitive, hit.barycentrics);
  if (shift == Shift::hybrid && connectable(to, y2.position, y2.normal))
    return result; // The inverse shift would not return the path.
  Reservoir& y = result.path;
  y.density = probe_pdf(to, y2.position, y2.normal);
  result.jacobian = replay_jacobian(path.density, path.hits, y.density, hits.count);
  y.hits = hits.count;
  y.instance = hit.instance;
  y.primitive = hit.primitive;
  y.barycentrics = hit.barycentrics;
  y.irradiance = {};
  if (!(result.jacobian > 0) || path.light >= scene.lights.size()) return result;
  const Light& light = scene.lights[path.light];
  y.irradiance = light_irradiance(light, path.place, y2.position, y2.normal, y2.shading);
  result.target = luminance(scattered(to, length(y2.position - to.position), y.irradiance));
  if (result.target > 0 &&
      !scene.visible(scene.of, y2, light_target(light, path.place, y2.position))) {
    y.irradiance = {};
    result.target = 0;
  }
  return result;
}

} // namespace

Shift shift_of_stage(Shift shift, Stage stage) {
  if (shift != Shift::sequential) return shift;
  return stage == Stage::spatial_second ? Shift::delayed : Shift::reconnection;
}

bool connectable(const Domain& domain, const Vector3& position, const Vector3& normal) {
  const double maximum = std::max({domain.d[0], domain.d[1], domain.d[2]});
  return dot(domain.normal, normal) <= connectable_cosine ||
         length(position - domain.position) >= connectable_distance_in_d * maximum;
}

double reconnection_jacobian(const Vector3& x, const Vector3& y, const Vector3& v,
                             const Vector3& normal) {
  const Vector3 from = v - x, to = v - y;
  const double from_square = dot(from, from), to_square = dot(to, to);
  const double from_cosine = std::abs(dot(from, normal)) / std::sqrt(from_square);
  const double to_cosine = std::abs(dot(to, normal)) / std::sqrt(to_square);
  const double jacobian = to_cosine / from_cosine * from_square / to_square;
  return std::isfinite(jacobian) ? jacobian : 0;
}

double replay_jacobian(double from_density, uint32_t from_hits, double to_density,
                       uint32_t to_hits) {
  if (!(from_density > 0) || !(to_density > 0) || from_hits == 0 || to_hits == 0) return 0;
  const double hits = from_hits == assumed_hits ? 1 : double(to_hits) / from_hits;
  const double jacobian = from_density / to_density * hits;
  return std::isfinite(jacobian) ? jacobian : 0;
}

Vector3 contribution_of(const Scene& scene, const Domain& domain, const Reservoir& path) {
  if (!has_sample(path)) return {};
  return scattered(domain, length(surface_of(scene, path).position - domain.position),
                   path.irradiance);
}

double target_of(const Scene& scene, const Domain& domain, const Reservoir& path) {
  return luminance(contribution_of(scene, domain, path));
}

void prepare(const Scene& scene, Shift shift, Index index, const Domain& domain, Reservoir& path,
             Random& random) {
  if (!has_sample(path) || path.hits > 0) return;
  const SurfacePoint x2 = surface_of(scene, path);
  const double technique = random_unit(random), within = random_unit(random);
  if (!replays(shift, domain, x2) ||
      !invert_point(domain, x2.position, x2.normal, technique, path.numbers))
    return;
  path.density = probe_pdf(domain, x2.position, x2.normal);
  if (index == Index::sampled) {
    path.numbers.pick = within;
    path.hits = assumed_hits;
    return;
  }
  ProbeHits hits;
  scene.trace_probe(scene.of, probe_of(domain, path.numbers), domain.medium, hits);
  if (invert_pick(hits, path.instance, path.primitive, within, path.numbers.pick))
    path.hits = hits.count;
}

Shifted shift_path(const Scene& scene, Shift shift, const Domain& from, const Domain& to,
                   const Reservoir& path) {
  Shifted none{path, 0, 0};
  if (!has_sample(path) || from.medium != to.medium) return none;
  if (shift == Shift::delayed) return replay(scene, shift, to, path);
  const SurfacePoint x2 = surface_of(scene, path);
  if (replays(shift, from, x2)) return replay(scene, shift, to, path);
  if (shift == Shift::hybrid && !connectable(to, x2.position, x2.normal)) return none;
  return reconnect(to, x2, path);
}

} // namespace dermis::restir
