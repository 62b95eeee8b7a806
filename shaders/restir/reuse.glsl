// Passes over reservoirs: initial sample, temporal reuse, spatial reuse, and resolve.
// tests/passes/restir/cpu/reuse.cpp mirrors and documents these functions in fp64 under the same
// names; its spatial_add is spatial_neighbour and two calls of spatial_move here.
#ifndef DERMIS_RESTIR_REUSE_GLSL
#define DERMIS_RESTIR_REUSE_GLSL

#include "restir/shift.glsl"

struct reuse_settings {
  uint shift; // shift of this stage: shift_of_stage
  uint index; // index_traced or index_sampled
  float cap;  // confidence_cap
};

// Returns the initial candidate of a pixel. A probe ray finds surfaces near the shading point; one
// hit becomes x2, where light enters. Then one position on one light is sampled, and one shadow ray
// is traced. Without a hit or light, the reservoir has no sample, but its confidence is 1. Always
// draws seven random numbers: four of the probe, which the reservoir stores (the last of them
// selects the hit), one of the light, and two of the position on the light.
reservoir draw_initial(scatter_domain domain, inout random_state random) {
  reservoir none = no_reservoir(1.0), candidate = none;
  float u[7];
  for (int i = 0; i < 7; ++i)
    u[i] = random_unit(random);
  if (!(scattering_reach(domain.d) > 0.0) || light_count() == 0u)
    return none;
  candidate.numbers = draw_numbers(domain.d, vec4(u[0], u[1], u[2], u[3]));
  chosen_hit chosen =
      trace_probe(probe_of(domain, candidate.numbers), domain.medium, hit_by_pick(u[3]));
  if (chosen.index >= chosen.count)
    return none;
  probe_hit hit = chosen.hit;
  surface_point x2 = surface_at(hit.instance, hit.primitive, hit.barycentrics);
  candidate.instance = hit.instance;
  candidate.primitive = hit.primitive;
  candidate.barycentrics = hit.barycentrics;
  candidate.hits = chosen.count;
  candidate.density = probe_pdf(domain, x2.position, x2.normal);
  candidate.light = pick_light(u[4]);
  candidate.place = light_place(u[5], u[6]);
  light_source light = light_at(candidate.light);
  candidate.irradiance =
      light_irradiance(light, candidate.place, x2.position, x2.normal, x2.shading);
  candidate.weight = float(chosen.count) / (candidate.density * light_density(light));
  float target =
      luminance(scattered(domain, length(x2.position - domain.position), candidate.irradiance));
  if (!(target > 0.0) || !visible(x2, light_target(light, candidate.place, x2.position)))
    return none;
  return sanitised(candidate);
}

// Returns x / (x + y) for densities; 0 if both are 0.
float restir_part(float x, float y) { return x > 0.0 ? x / (x + y) : 0.0; }

// A path and its pixel.
struct pixel_path {
  scatter_domain domain;
  reservoir path;
};

void swap_paths(inout pixel_path a, inout pixel_path b) {
  pixel_path kept = a;
  a = b;
  b = kept;
}

struct moved_path {
  float target; // of the path in its own pixel
  shifted_path image;
};

// Finds the path's image in the pixel `to`. The path gets its random numbers if `prepares` and the
// shift replays.
moved_path move_path(reuse_settings settings, bool prepares, uint lights, inout pixel_path moving,
                     scatter_domain to, inout random_state random) {
  moved_path moved = moved_path(0.0, shifted_path(moving.path, 0.0, 0.0));
  if (!has_sample(moving.path))
    return moved;
  surface_point x2 = surface_of(moving.path);
  if (prepares)
    prepare(settings.shift, settings.index, moving.domain, x2, moving.path, random);
  moved.target = target_of(moving.domain, x2, moving.path);
  moved.image = shift_path(settings.shift, lights, moving.domain, to, x2, moving.path);
  return moved;
}

// Merges frame and history by the generalised balance heuristic. Both paths move in a loop that
// swaps them, because a driver then compiles the body only once and no array is indexed.
reservoir merge_temporal(reuse_settings settings, scatter_domain domain, reservoir current,
                         scatter_domain previous_domain, reservoir previous,
                         inout random_state random) {
  pixel_path own = pixel_path(domain, sanitised(current)),
             history = pixel_path(previous_domain, sanitised(previous));
  history.path.confidence = min(history.path.confidence, settings.cap * own.path.confidence);
  float target = 0.0, back_target = 0.0, back_jacobian = 0.0;
  moved_path moved;
  for (uint i = 0u; i < 2u; ++i) {
    // The own path moves to the previous frame.
    moved = move_path(settings, true, i == 0u ? lights_before : lights_now, own, history.domain,
                      random);
    if (i == 0u) {
      target = moved.target;
      back_target = moved.image.target;
      back_jacobian = moved.image.jacobian;
    }
    swap_paths(own, history);
  }
  reservoir_stream stream = stream_begin();

  float own_mis = restir_part(own.path.confidence * target,
                              history.path.confidence * back_target * back_jacobian);
  stream_add(stream, own.path, target, own_mis * target * own.path.weight, own.path.confidence,
             random_unit(random));

  shifted_path here = moved.image;
  float there = here.jacobian > 0.0 ? moved.target / here.jacobian : 0.0;
  float mis = restir_part(history.path.confidence * there, own.path.confidence * here.target);
  stream_add(stream, here.path, here.target,
             mis * here.target * history.path.weight * here.jacobian, history.path.confidence,
             random_unit(random));
  return stream_end(stream);
}

// Defensive pairwise MIS. The pixel's own path moves to a neighbour, and the neighbour's path moves
// to the pixel. A kernel calls spatial_move once after spatial_begin and twice after each
// spatial_neighbour, in one loop for all moves, because a driver then compiles the move only once.
struct spatial_merge {
  reservoir_stream stream;
  uint move;                // the next move
  pixel_path moving, other; // one of them is the pixel's own path
  float own_target, own_mis;
  float neighbours; // sum of the neighbours' confidences
};
const uint move_none = 0u; // prepares the own path
const uint move_back = 1u; // own path to the neighbour of spatial_neighbour
const uint move_here = 2u; // the neighbour's path to the pixel

spatial_merge spatial_begin(scatter_domain domain, reservoir own, float neighbours) {
  spatial_merge spatial;
  spatial.stream = stream_begin();
  spatial.move = move_none;
  spatial.moving = pixel_path(domain, sanitised(own));
  spatial.other = spatial.moving;
  spatial.other.domain.medium = 0u; // no path has an image there
  spatial.own_target = 0.0;
  spatial.neighbours = max(neighbours, 0.0);
  spatial.own_mis = restir_part(spatial.moving.path.confidence, spatial.neighbours);
  return spatial;
}

void spatial_neighbour(inout spatial_merge spatial, scatter_domain domain, reservoir neighbour) {
  spatial.other = pixel_path(domain, sanitised(neighbour));
}

void spatial_move(reuse_settings settings, inout spatial_merge spatial,
                  inout random_state random) {
  moved_path moved = move_path(settings, spatial.move != move_back, lights_kept, spatial.moving,
                               spatial.other.domain, random);
  if (spatial.move == move_none) {
    spatial.own_target = moved.target;
    spatial.move = move_back;
    return;
  }
  bool back = spatial.move == move_back;
  float own = spatial.other.path.confidence, other = spatial.moving.path.confidence;
  if (back) {
    own = spatial.moving.path.confidence;
    other = spatial.other.path.confidence;
  }
  shifted_path image = moved.image;
  float fraction = restir_part(other, own + spatial.neighbours - other);
  if (back) {
    spatial.own_mis += fraction * restir_part(own * spatial.own_target, spatial.neighbours *
                                                                            image.target *
                                                                            image.jacobian);
  } else {
    float there = image.jacobian > 0.0 ? moved.target / image.jacobian : 0.0;
    float mis = fraction * restir_part(spatial.neighbours * there, own * image.target);
    stream_add(spatial.stream, image.path, image.target,
               mis * image.target * spatial.moving.path.weight * image.jacobian, other,
               random_unit(random));
  }
  swap_paths(spatial.moving, spatial.other);
  spatial.move = back ? move_here : move_back;
}

reservoir spatial_end(inout spatial_merge spatial, inout random_state random) {
  reservoir own = spatial.moving.path;
  stream_add(spatial.stream, own, spatial.own_target,
             spatial.own_mis * spatial.own_target * own.weight, own.confidence,
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
