#include "tests/passes/restir/cpu/reuse.hpp"

#include <algorithm>
#include <numbers>

namespace dermis::restir {

namespace {

constexpr double min_search_px = 5, max_search_px = 30, search_in_d = 2;

// Returns x / (x + y) for densities, or 0 if both are 0.
double part(double x, double y) {
  return x > 0 ? x / (x + y) : 0;
}

// Updates a shifted path to these lights.
void relight(const Scene& scene, std::span<const Light> lights, const Domain& domain,
             Shifted& shifted) {
  Reservoir& path = shifted.path;
  if (!(shifted.jacobian > 0)) return;
  path.irradiance = {};
  shifted.target = 0;
  if (path.light >= lights.size()) return;
  const SurfacePoint x2 =
      scene.surface_at(scene.of, path.instance, path.primitive, path.barycentrics);
  const Light& light = lights[path.light];
  const Vector3 irradiance =
      light_irradiance(light, path.place, x2.position, x2.normal, x2.shading);
  const double target =
      luminance(scattered(domain, length(x2.position - domain.position), irradiance));
  if (!(target > 0) || !scene.visible(scene.of, x2, light_target(light, path.place, x2.position)))
    return;
  path.irradiance = irradiance;
  shifted.target = target;
}

} // namespace

Reservoir draw_initial(const Scene& scene, const Domain& domain, Random& random) {
  Reservoir none;
  none.confidence = 1;
  const double technique = random_unit(random), radius = random_unit(random),
               angle = random_unit(random), pick = random_unit(random), which = random_unit(random),
               u = random_unit(random), v = random_unit(random);
  if (!(scattering_reach(domain.d) > 0) || scene.lights.empty()) return none;
  Reservoir candidate = none;
  candidate.numbers = draw_numbers(domain.d, {technique, radius, angle, pick});
  ProbeHits hits;
  scene.trace_probe(scene.of, probe_of(domain, candidate.numbers), domain.medium, hits);
  if (hits.count == 0) return none;
  const ProbeHit& hit = hits.hit[picked_hit(pick, hits.count)];
  const SurfacePoint x2 = scene.surface_at(scene.of, hit.instance, hit.primitive, hit.barycentrics);
  candidate.instance = hit.instance;
  candidate.primitive = hit.primitive;
  candidate.barycentrics = hit.barycentrics;
  candidate.hits = hits.count;
  candidate.density = probe_pdf(domain, x2.position, x2.normal);
  candidate.light = pick_light(scene.lights, which);
  candidate.place = light_place(u, v);
  const Light& light = scene.lights[candidate.light];
  candidate.irradiance =
      light_irradiance(light, candidate.place, x2.position, x2.normal, x2.shading);
  candidate.weight = hits.count / (candidate.density * light_density(light));
  const double target =
      luminance(scattered(domain, length(x2.position - domain.position), candidate.irradiance));
  if (!(target > 0) ||
      !scene.visible(scene.of, x2, light_target(light, candidate.place, x2.position)))
    return none;
  return sanitised(candidate);
}

Reservoir merge_temporal(const Scene& scene, const ReuseSettings& settings, const Domain& domain,
                         const Reservoir& current, const Domain& previous_domain,
                         const Reservoir& previous, Random& random) {
  Reservoir own = sanitised(current), history = sanitised(previous);
  history.confidence = std::min(history.confidence, settings.cap * own.confidence);
  prepare(scene, settings.shift, settings.index, domain, own, random);
  prepare(scene, settings.shift, settings.index, previous_domain, history, random);
  Stream stream;

  const double target = target_of(scene, domain, own);
  Shifted back = shift_path(scene, settings.shift, domain, previous_domain, own);
  if (!scene.previous_lights.empty()) relight(scene, scene.previous_lights, previous_domain, back);
  const double own_mis =
      part(own.confidence * target, history.confidence * back.target * back.jacobian);
  stream_add(stream, own, target, own_mis * target * own.weight, own.confidence,
             random_unit(random));

  Shifted here = shift_path(scene, settings.shift, previous_domain, domain, history);
  if (!scene.previous_lights.empty()) relight(scene, scene.lights, domain, here);
  const double there =
      here.jacobian > 0 ? target_of(scene, previous_domain, history) / here.jacobian : 0;
  const double mis = part(history.confidence * there, own.confidence * here.target);
  stream_add(stream, here.path, here.target, mis * here.target * history.weight * here.jacobian,
             history.confidence, random_unit(random));
  return stream_end(stream);
}

Spatial spatial_begin(const Scene& scene, const ReuseSettings& settings, const Domain& domain,
                      const Reservoir& own, double neighbours, Random& random) {
  Spatial spatial;
  spatial.own = sanitised(own);
  spatial.neighbours = std::max(neighbours, 0.0);
  prepare(scene, settings.shift, settings.index, domain, spatial.own, random);
  spatial.own_target = target_of(scene, domain, spatial.own);
  spatial.own_mis = part(spatial.own.confidence, spatial.neighbours);
  return spatial;
}

void spatial_add(const Scene& scene, const ReuseSettings& settings, const Domain& domain,
                 Spatial& spatial, const Domain& neighbour_domain, const Reservoir& neighbour,
                 Random& random) {
  Reservoir other = sanitised(neighbour);
  const double own_confidence = spatial.own.confidence;
  const double fraction =
      part(other.confidence, own_confidence + spatial.neighbours - other.confidence);
  prepare(scene, settings.shift, settings.index, neighbour_domain, other, random);

  const Shifted back = shift_path(scene, settings.shift, domain, neighbour_domain, spatial.own);
  spatial.own_mis += fraction * part(own_confidence * spatial.own_target,
                                     spatial.neighbours * back.target * back.jacobian);

  const Shifted here = shift_path(scene, settings.shift, neighbour_domain, domain, other);
  const double there =
      here.jacobian > 0 ? target_of(scene, neighbour_domain, other) / here.jacobian : 0;
  const double mis = fraction * part(spatial.neighbours * there, own_confidence * here.target);
  stream_add(spatial.stream, here.path, here.target,
             mis * here.target * other.weight * here.jacobian, other.confidence,
             random_unit(random));
}

Reservoir spatial_end(Spatial& spatial, Random& random) {
  stream_add(spatial.stream, spatial.own, spatial.own_target,
             spatial.own_mis * spatial.own_target * spatial.own.weight, spatial.own.confidence,
             random_unit(random));
  return stream_end(spatial.stream);
}

Vector3 resolve(const Scene& scene, const Domain& domain, const Reservoir& reservoir) {
  const Reservoir clean = sanitised(reservoir);
  return clean.weight * contribution_of(scene, domain, clean);
}

double search_radius(const Vector3& d, double footprint) {
  const double px = search_in_d * std::max({d[0], d[1], d[2]}) / footprint;
  // NaN gives the minimum.
  return px >= min_search_px ? std::min(px, max_search_px) : min_search_px;
}

std::array<int, 2> neighbour_offset(double radius, Random& random) {
  const double r = radius * std::sqrt(random_unit(random));
  const double angle = 2 * std::numbers::pi * random_unit(random);
  return {static_cast<int>(std::lround(r * std::cos(angle))),
          static_cast<int>(std::lround(r * std::sin(angle)))};
}

} // namespace dermis::restir
