// Shift mappings: map a path of one pixel to a path of another. tests/passes/restir/cpu/shift.cpp
// mirrors and documents these functions in fp64 under the same names.
#ifndef DERMIS_RESTIR_SHIFT_GLSL
#define DERMIS_RESTIR_SHIFT_GLSL

#include "restir/random.glsl"
#include "restir/reservoir.glsl"
#include "restir/scene.glsl"

const uint shift_reconnection = 0u, shift_delayed = 1u, shift_hybrid = 2u, shift_sequential = 3u;
const uint stage_temporal = 0u, stage_spatial_first = 1u, stage_spatial_second = 2u;
const uint index_traced = 0u, index_sampled = 1u;
// How shift_path lights a path in the new pixel: reconnected paths keep their light; or all paths
// are lit by the lights of this frame or of the previous frame.
const uint lights_kept = 0u, lights_now = 1u, lights_before = 2u;

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
  float maximum = max(domain.d.r, max(domain.d.g, domain.d.b));
  return dot(domain.normal, normal) <= connectable_cosine ||
         length(position - domain.position) >= connectable_distance_in_d * maximum;
}

bool replays(uint shift, scatter_domain domain, surface_point x2) {
  return shift == shift_delayed ||
         (shift == shift_hybrid && !connectable(domain, x2.position, x2.normal));
}

// Returns the Jacobian of replayed random numbers per area, including the choice among hits.
float replay_jacobian(float from_density, uint from_hits, float to_density, uint to_hits) {
  if (!(from_density > 0.0) || !(to_density > 0.0) || from_hits == 0u || to_hits == 0u)
    return 0.0;
  float hits = from_hits == assumed_hits ? 1.0 : float(to_hits) / float(from_hits);
  float jacobian = from_density / to_density * hits;
  return is_usable(jacobian) ? jacobian : 0.0;
}

surface_point surface_of(reservoir path) {
  return surface_at(path.instance, path.primitive, path.barycentrics);
}

vec3 contribution_of(scatter_domain domain, surface_point x2, reservoir path) {
  if (!has_sample(path))
    return vec3(0.0);
  return scattered(domain, length(x2.position - domain.position), path.irradiance);
}
float target_of(scatter_domain domain, surface_point x2, reservoir path) {
  return luminance(contribution_of(domain, x2, path));
}

// The functions below take x2, the surface_of the path, as a parameter, and only shift_path lights
// the path. A driver then compiles each surface read and each ray only once.

shifted_path reconnect(scatter_domain to, surface_point x2, reservoir path) {
  path.hits = 0u;
  return shifted_path(path, 1.0, target_of(to, x2, path));
}

// Returns the path without light; sets `x2` to the end of the replayed probe.
shifted_path replay(uint shift, scatter_domain to, reservoir path, inout surface_point x2) {
  shifted_path result = shifted_path(path, 0.0, 0.0);
  if (path.hits == 0u)
    return result;
  chosen_hit chosen =
      trace_probe(probe_of(to, path.numbers), to.medium, hit_by_pick(path.numbers.pick));
  if (chosen.index >= chosen.count)
    return result;
  probe_hit hit = chosen.hit;
  x2 = surface_at(hit.instance, hit.primitive, hit.barycentrics);
  // the inverse shift would reconnect
  if (shift == shift_hybrid && connectable(to, x2.position, x2.normal))
    return result;
  result.path.density = probe_pdf(to, x2.position, x2.normal);
  result.jacobian = replay_jacobian(path.density, path.hits, result.path.density, chosen.count);
  result.path.hits = chosen.count;
  result.path.instance = hit.instance;
  result.path.primitive = hit.primitive;
  result.path.barycentrics = hit.barycentrics;
  return result;
}

// Lights the path in the pixel that it was shifted to, with its light of this frame or of the frame
// before.
void relight(bool before, scatter_domain domain, surface_point x2, inout shifted_path shifted) {
  shifted.path.irradiance = vec3(0.0);
  shifted.target = 0.0;
  if (!(shifted.jacobian > 0.0) || shifted.path.light >= light_count())
    return;
  light_source light = light_at(shifted.path.light);
  if (before)
    light = previous_light_at(shifted.path.light);
  vec3 irradiance = light_irradiance(light, shifted.path.place, x2.position, x2.normal, x2.shading);
  float target = luminance(scattered(domain, length(x2.position - domain.position), irradiance));
  if (target > 0.0 && visible(x2, light_target(light, shifted.path.place, x2.position))) {
    shifted.path.irradiance = irradiance;
    shifted.target = target;
  }
}

// Finds the random numbers that `shift` will replay, by probabilistic inversion in the path's own
// pixel. Call this once for each path and pass. If no numbers lead to x2, hits stays 0 and no
// replay succeeds.
void prepare(uint shift, uint index, scatter_domain domain, surface_point x2, inout reservoir path,
             inout random_state random) {
  if (!has_sample(path) || path.hits > 0u)
    return;
  float technique = random_unit(random);
  float within = random_unit(random);
  if (!replays(shift, domain, x2) ||
      !invert_point(domain, x2.position, x2.normal, technique, path.numbers))
    return;
  path.density = probe_pdf(domain, x2.position, x2.normal);
  if (index == index_sampled) {
    path.numbers.pick = within;
    path.hits = assumed_hits;
    return;
  }
  chosen_hit chosen = trace_probe(probe_of(domain, path.numbers), domain.medium,
                                  hit_on_primitive(path.instance, path.primitive));
  if (chosen.index >= chosen.count)
    return;
  path.numbers.pick = invert_pick(chosen.index, chosen.count, within);
  path.hits = chosen.count;
}

// Shifts a path. `shift` must not be shift_sequential: call shift_of_stage first.
shifted_path shift_path(uint shift, uint lights, scatter_domain from, scatter_domain to,
                        surface_point x2, reservoir path) {
  shifted_path none = shifted_path(path, 0.0, 0.0);
  if (!has_sample(path) || from.medium != to.medium)
    return none;
  bool replayed = replays(shift, from, x2);
  if (!replayed && shift == shift_hybrid && !connectable(to, x2.position, x2.normal))
    return none;
  shifted_path image = none;
  if (replayed)
    image = replay(shift, to, path, x2);
  else
    image = reconnect(to, x2, path);
  if (replayed || lights != lights_kept)
    relight(lights == lights_before, to, x2, image);
  return image;
}

#endif
