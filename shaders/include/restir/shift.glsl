// Shift mappings: a path of one pixel becomes a path of another. passes/restir/shift.cpp mirrors these functions in
// fp64 under the same names and says what they mean.
#ifndef DERMIS_RESTIR_SHIFT_GLSL
#define DERMIS_RESTIR_SHIFT_GLSL

#include "restir/random.glsl"
#include "restir/reservoir.glsl"
#include "restir/scene.glsl"

const uint shift_reconnection = 0u, shift_delayed = 1u, shift_hybrid = 2u, shift_sequential = 3u;
const uint stage_temporal = 0u, stage_spatial_first = 1u, stage_spatial_second = 2u;
const uint index_traced = 0u, index_drawn = 1u;

const float connectable_cosine = 0.5, connectable_distance_in_d = 2.0;

struct shifted_path {
  reservoir path;
  float jacobian; // 0: the path has no image
  float target;   // in the new pixel
};

uint shift_of_stage(uint shift, uint stage) {
  if (shift != shift_sequential)
    return shift;
  return stage == stage_spatial_second ? shift_delayed : shift_reconnection;
}

bool connectable(scatter_domain domain, vec3 position, vec3 normal) {
  float most = max(domain.d.r, max(domain.d.g, domain.d.b));
  return dot(domain.normal, normal) <= connectable_cosine ||
         length(position - domain.position) >= connectable_distance_in_d * most;
}

bool replays(uint shift, scatter_domain domain, surface_point x2) {
  return shift == shift_delayed || (shift == shift_hybrid && !connectable(domain, x2.position, x2.normal));
}

// Of replayed random numbers per area, the choice among hits included.
float replay_jacobian(float from_density, uint from_hits, float to_density, uint to_hits) {
  if (!(from_density > 0.0) || !(to_density > 0.0) || from_hits == 0u || to_hits == 0u)
    return 0.0;
  float hits = from_hits == assumed_hits ? 1.0 : float(to_hits) / float(from_hits);
  float jacobian = from_density / to_density * hits;
  return is_usable(jacobian) ? jacobian : 0.0;
}

surface_point surface_of(reservoir path) { return surface_at(path.instance, path.primitive, path.barycentrics); }

vec3 contribution_of(scatter_domain domain, reservoir path) {
  if (!has_sample(path))
    return vec3(0.0);
  return scattered(domain, length(surface_of(path).position - domain.position), path.irradiance);
}
float target_of(scatter_domain domain, reservoir path) { return luminance(contribution_of(domain, path)); }

shifted_path reconnect(scatter_domain to, surface_point x2, reservoir path) {
  path.hits = 0u;
  return shifted_path(path, 1.0, luminance(scattered(to, length(x2.position - to.position), path.irradiance)));
}

shifted_path replay(uint shift, scatter_domain to, reservoir path) {
  shifted_path result = shifted_path(path, 0.0, 0.0);
  if (path.hits == 0u)
    return result;
  probe_hits hits;
  trace_probe(probe_of(to, path.numbers), to.medium, hits);
  if (hits.count == 0u)
    return result;
  probe_hit hit = hits.hit[picked_hit(path.numbers.pick, hits.count)];
  surface_point y2 = surface_at(hit.instance, hit.primitive, hit.barycentrics);
  if (shift == shift_hybrid && connectable(to, y2.position, y2.normal)) // would not come back so
    return result;
  result.path.density = probe_pdf(to, y2.position, y2.normal);
  result.jacobian = replay_jacobian(path.density, path.hits, result.path.density, hits.count);
  result.path.hits = hits.count;
  result.path.instance = hit.instance;
  result.path.primitive = hit.primitive;
  result.path.barycentrics = hit.barycentrics;
  result.path.irradiance = vec3(0.0);
  if (!(result.jacobian > 0.0) || path.light >= light_count())
    return result;
  light_source light = light_at(path.light);
  vec3 irradiance = light_irradiance(light, path.place, y2.position, y2.normal, y2.shading);
  float target = luminance(scattered(to, length(y2.position - to.position), irradiance));
  if (target > 0.0 && visible(y2, light_target(light, path.place, y2.position))) {
    result.path.irradiance = irradiance;
    result.target = target;
  }
  return result;
}

// Finds the random numbers that `shift` will replay by probabilistic inversion in the path's own pixel; once for each
// path and pass. Where none lead there, hits stays 0 and no replay succeeds.
void prepare(uint shift, uint index, scatter_domain domain, inout reservoir path, inout random_state random) {
  if (!has_sample(path) || path.hits > 0u)
    return;
  surface_point x2 = surface_of(path);
  float technique = random_unit(random);
  float within = random_unit(random);
  if (!replays(shift, domain, x2) || !invert_point(domain, x2.position, x2.normal, technique, path.numbers))
    return;
  path.density = probe_pdf(domain, x2.position, x2.normal);
  if (index == index_drawn) {
    path.numbers.pick = within;
    path.hits = assumed_hits;
    return;
  }
  probe_hits hits;
  trace_probe(probe_of(domain, path.numbers), domain.medium, hits);
  if (invert_pick(hits, path.instance, path.primitive, within, path.numbers.pick))
    path.hits = hits.count;
}

// `shift` is none of a sequence: ask shift_of_stage first.
shifted_path shift_path(uint shift, scatter_domain from, scatter_domain to, reservoir path) {
  shifted_path none = shifted_path(path, 0.0, 0.0);
  if (!has_sample(path) || from.medium != to.medium)
    return none;
  if (shift == shift_delayed)
    return replay(shift, to, path);
  surface_point x2 = surface_of(path);
  if (replays(shift, from, x2))
    return replay(shift, to, path);
  if (shift == shift_hybrid && !connectable(to, x2.position, x2.normal))
    return none;
  return reconnect(to, x2, path);
}

#endif
