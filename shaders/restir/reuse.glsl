// Passes over reservoirs: initial sample, temporal reuse, spatial reuse, and resolve.
// tests/passes/restir/cpu/reuse.cpp mirrors and documents these functions in fp64 under the same
// names.
#ifndef DERMIS_RESTIR_REUSE_GLSL
#define DERMIS_RESTIR_REUSE_GLSL

#include "restir/shift.glsl"

struct reuse_settings {
  uint shift; // shift of this stage: shift_of_stage
  uint index; // index_traced or index_sampled
  float cap;  // confidence_cap
};

// Samples one x2 by a probe, one place on one light, and one shadow ray. Confidence is 1, even
// without a sample.
reservoir draw_initial(scatter_domain domain, inout random_state random) {
  reservoir none = no_reservoir(1.0), candidate = none;
  float u[7];
  for (int i = 0; i < 7; ++i)
    u[i] = random_unit(random);
  if (!(scattering_reach(domain.d) > 0.0) || light_count() == 0u)
    return none;
  candidate.numbers = draw_numbers(domain.d, vec4(u[0], u[1], u[2], u[3]));
  probe_hits hits;
  trace_probe(probe_of(domain, candidate.numbers), domain.medium, hits);
  if (hits.count == 0u)
    return none;
  probe_hit hit = hits.hit[picked_hit(u[3], hits.count)];
  surface_point x2 = surface_at(hit.instance, hit.primitive, hit.barycentrics);
  candidate.instance = hit.instance;
  candidate.primitive = hit.primitive;
  candidate.barycentrics = hit.barycentrics;
  candidate.hits = hits.count;
  candidate.density = probe_pdf(domain, x2.position, x2.normal);
  candidate.light = pick_light(u[4]);
  candidate.place = light_place(u[5], u[6]);
  light_source light = light_at(candidate.light);
  candidate.irradiance =
      light_irradiance(light, candidate.place, x2.position, x2.normal, x2.shading);
  candidate.weight = float(hits.count) / (candidate.density * light_density(light));
  float target =
      luminance(scattered(domain, length(x2.position - domain.position), candidate.irradiance));
  if (!(target > 0.0) || !visible(x2, light_target(light, candidate.place, x2.position)))
    return none;
  return sanitised(candidate);
}

// Returns x / (x + y) for densities; 0 if both are 0.
float restir_part(float x, float y) { return x > 0.0 ? x / (x + y) : 0.0; }

// Two paths, each with its pixel's domain and target there, and their images in each other's
// domain. A loop over both, because a driver then compiles the body only once.
struct exchange {
  scatter_domain domain[2];
  reservoir path[2];
  float target[2];
  shifted_path image[2]; // path i in domain 1 - i
};

// `first`: index of the first path that must be prepared, 0 or 1.
void exchange_paths(reuse_settings settings, uint first, bool over_time, inout exchange both,
                    inout random_state random) {
  for (uint i = 0u; i < 2u; ++i) {
    both.target[i] = 0.0;
    both.image[i] = shifted_path(both.path[i], 0.0, 0.0);
    if (!has_sample(both.path[i]))
      continue;
    surface_point x2 = surface_of(both.path[i]);
    if (i >= first)
      prepare(settings.shift, settings.index, both.domain[i], x2, both.path[i], random);
    both.target[i] = target_of(both.domain[i], x2, both.path[i]);
    // Over time, path 0 moves to the frame before.
    uint lights = !over_time ? lights_kept : i == 0u ? lights_before : lights_now;
    both.image[i] =
        shift_path(settings.shift, lights, both.domain[i], both.domain[1u - i], x2, both.path[i]);
  }
}

// Merges frame and history by the generalised balance heuristic.
reservoir merge_temporal(reuse_settings settings, scatter_domain domain, reservoir current,
                         scatter_domain previous_domain, reservoir previous,
                         inout random_state random) {
  exchange both;
  both.domain = scatter_domain[2](domain, previous_domain);
  both.path = reservoir[2](sanitised(current), sanitised(previous));
  both.path[1].confidence = min(both.path[1].confidence, settings.cap * both.path[0].confidence);
  exchange_paths(settings, 0u, true, both, random);
  reservoir own = both.path[0], history = both.path[1];
  shifted_path back = both.image[0], here = both.image[1];
  reservoir_stream stream = stream_begin();

  float target = both.target[0];
  float own_mis =
      restir_part(own.confidence * target, history.confidence * back.target * back.jacobian);
  stream_add(stream, own, target, own_mis * target * own.weight, own.confidence,
             random_unit(random));

  float there = here.jacobian > 0.0 ? both.target[1] / here.jacobian : 0.0;
  float mis = restir_part(history.confidence * there, own.confidence * here.target);
  stream_add(stream, here.path, here.target, mis * here.target * history.weight * here.jacobian,
             history.confidence, random_unit(random));
  return stream_end(stream);
}

// Defensive pairwise MIS: spatial_begin, spatial_add for each neighbour, spatial_end.
struct spatial_merge {
  reservoir_stream stream;
  reservoir own; // with its random numbers if the shift replays
  float own_target, own_mis;
  float neighbours; // sum of the neighbours' confidences
};

spatial_merge spatial_begin(reuse_settings settings, scatter_domain domain, reservoir own,
                            float neighbours, inout random_state random) {
  spatial_merge spatial;
  spatial.stream = stream_begin();
  spatial.own = sanitised(own);
  spatial.neighbours = max(neighbours, 0.0);
  spatial.own_target = 0.0;
  if (has_sample(spatial.own)) {
    surface_point x2 = surface_of(spatial.own);
    prepare(settings.shift, settings.index, domain, x2, spatial.own, random);
    spatial.own_target = target_of(domain, x2, spatial.own);
  }
  spatial.own_mis = restir_part(spatial.own.confidence, spatial.neighbours);
  return spatial;
}

void spatial_add(reuse_settings settings, scatter_domain domain, inout spatial_merge spatial,
                 scatter_domain neighbour_domain, reservoir neighbour, inout random_state random) {
  exchange both;
  both.domain = scatter_domain[2](domain, neighbour_domain);
  both.path = reservoir[2](spatial.own, sanitised(neighbour));
  exchange_paths(settings, 1u, false, both, random);
  reservoir other = both.path[1];
  shifted_path back = both.image[0], here = both.image[1];
  float own_confidence = spatial.own.confidence;
  float fraction =
      restir_part(other.confidence, own_confidence + spatial.neighbours - other.confidence);
  spatial.own_mis += fraction * restir_part(own_confidence * spatial.own_target,
                                         spatial.neighbours * back.target * back.jacobian);
  float there = here.jacobian > 0.0 ? both.target[1] / here.jacobian : 0.0;
  float mis = fraction * restir_part(spatial.neighbours * there, own_confidence * here.target);
  stream_add(spatial.stream, here.path, here.target,
             mis * here.target * other.weight * here.jacobian, other.confidence,
             random_unit(random));
}

reservoir spatial_end(inout spatial_merge spatial, inout random_state random) {
  stream_add(spatial.stream, spatial.own, spatial.own_target,
             spatial.own_mis * spatial.own_target * spatial.own.weight, spatial.own.confidence,
             random_unit(random));
  return stream_end(spatial.stream);
}

// Returns the pixel's estimate: scattered diffuse light before albedo.
vec3 resolve(scatter_domain domain, reservoir r) {
  r = sanitised(r);
  if (!has_sample(r))
    return vec3(0.0);
  return r.weight * contribution_of(domain, surface_of(r), r);
}

// Returns the search radius for neighbours in pixels. `footprint`: size of a pixel across the view
// at x1, in the unit of d.
float search_radius(vec3 d, float footprint) {
  float px = 2.0 * max(d.r, max(d.g, d.b)) / footprint;
  return px >= 5.0 ? min(px, 30.0) : 5.0;
}

// Returns an offset from the pixel to a neighbour, uniform over the disc.
ivec2 neighbour_offset(float radius, inout random_state random) {
  float r = radius * sqrt(random_unit(random));
  float angle = 2.0 * restir_pi * random_unit(random);
  return ivec2(round(r * vec2(cos(angle), sin(angle))));
}

#endif
