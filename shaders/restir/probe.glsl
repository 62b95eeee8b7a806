// BSSRDF importance sampling by probe rays, its density and its inversion.
// tests/passes/restir/cpu/probe.cpp mirrors and documents these functions in fp64 under the same
// names. The CPU functions keep all hits of a probe; on a device, hits.glsl finds one of them.
#ifndef DERMIS_RESTIR_PROBE_GLSL
#define DERMIS_RESTIR_PROBE_GLSL

#extension GL_EXT_control_flow_attributes : require
#include "restir/domain.glsl"

const vec3 probe_axis_fraction = vec3(0.5, 0.25, 0.25); // probabilities of normal, tangents
const uint max_probe_hits = 16u;
// Hit count of a probe that was not traced: taken as equal to any count it is compared with.
const uint assumed_hits = 255u;

struct probe_numbers {
  uint axis, channel;
  float survival; // 1 - probe_fraction u
  float angle;    // fraction of a full turn
  float pick;     // selects one of the hits
};
struct probe_ray {
  vec3 origin, direction; // direction: unit length
  float reach;            // length of the ray
};
struct probe_hit {
  uint instance, primitive;
  vec2 barycentrics; // of the second and third vertex
  float distance;
};
// The hit to find: the hit that a number picks, or the hit on a primitive.
struct hit_choice {
  bool by_primitive;
  float pick;
  uint instance, primitive;
};
struct chosen_hit {
  uint count; // number of hits of the probe, at most max_probe_hits
  uint index; // by distance; equal to `count` if no hit was found
  probe_hit hit;
};

hit_choice hit_by_pick(float pick) { return hit_choice(false, pick, 0u, 0u); }
hit_choice hit_on_primitive(uint instance, uint primitive) {
  return hit_choice(true, 0.0, instance, primitive);
}

uint scattering_channels(vec3 d) { return uint(d.r > 0.0) + uint(d.g > 0.0) + uint(d.b > 0.0); }

// Returns the index of the selected hit of `count` > 0 hits.
uint picked_hit(float pick, uint count) {
  return min(uint(max(pick, 0.0) * float(count)), count - 1u);
}

// Maps four uniform numbers to axis and channel, radius, angle, and pick.
probe_numbers draw_numbers(vec3 d, vec4 u) {
  probe_numbers numbers;
  numbers.axis = 0u;
  numbers.channel = 0u;
  float below = 0.0;
  while (numbers.axis < 2u && u.x >= below + probe_axis_fraction[numbers.axis])
    below += probe_axis_fraction[numbers.axis++];
  uint skip = picked_hit((u.x - below) / probe_axis_fraction[numbers.axis],
                         max(1u, scattering_channels(d)));
  for (uint c = 0u; c < 3u; ++c)
    if (d[c] > 0.0 && skip-- == 0u) {
      numbers.channel = c;
      break;
    }
  numbers.survival = 1.0 - probe_fraction * u.y;
  numbers.angle = u.z;
  numbers.pick = u.w;
  return numbers;
}

// Solves s^3 + 3 s = 4 u by Newton steps from the sampler's approximation, because asinh loses
// digits in fp32.
float burley_root(float u) {
  float s = burley_sample_root(u);
  for (int i = 0; i < 2; ++i)
    s -= (s * (s * s + 3.0) - 4.0 * u) / (3.0 * (s * s + 1.0));
  return s;
}
float burley_radius(float survival, float d) {
  return max(0.0, -3.0 * d * log(burley_root(clamp(survival, burley_min_survival, 1.0))));
}

// Returns the chord through the point on the disc, of the ball whose radius is the channel's reach.
probe_ray probe_of(scatter_domain domain, probe_numbers numbers) {
  float d = domain.d[numbers.channel];
  float r = burley_radius(numbers.survival, d);
  float reach = reach_in_d * d, phi = 2.0 * restir_pi * numbers.angle;
  float chord = sqrt(max(0.0, reach * reach - r * r));
  vec3 axis = probe_axis(domain.normal, numbers.axis);
  vec3 point = domain.position +
               r * cos(phi) * probe_axis(domain.normal, (numbers.axis + 1u) % 3u) +
               r * sin(phi) * probe_axis(domain.normal, (numbers.axis + 2u) % 3u);
  return probe_ray(point + chord * axis, -axis, 2.0 * chord);
}

vec2 on_probe_disc(scatter_domain domain, uint axis, vec3 offset) {
  return vec2(dot(offset, probe_axis(domain.normal, (axis + 1u) % 3u)),
              dot(offset, probe_axis(domain.normal, (axis + 2u) % 3u)));
}

// Returns the density per area for one axis and channel, including their probability but not the
// choice among hits.
float probe_technique_pdf(scatter_domain domain, uint axis, uint channel, vec3 position,
                          vec3 normal) {
  float d = domain.d[channel];
  vec3 offset = position - domain.position;
  if (!(d > 0.0) || !(length(offset) <= reach_in_d * d))
    return 0.0;
  float r = max(length(on_probe_disc(domain, axis, offset)), min_radius_in_d * d);
  float cosine = abs(dot(normal, probe_axis(domain.normal, axis)));
  return probe_axis_fraction[axis] / float(scattering_channels(domain.d)) * cosine *
         burley_R(r, d) / probe_fraction;
}

// Returns the density per area over all axes and channels.
float probe_pdf(scatter_domain domain, vec3 position, vec3 normal) {
  float sum = 0.0;
  [[dont_unroll]] for (uint axis = 0u; axis < 3u; ++axis)
    [[dont_unroll]] for (uint channel = 0u; channel < 3u; ++channel)
      sum += probe_technique_pdf(domain, axis, channel, position, normal);
  return sum;
}

// Probabilistic inversion: finds numbers that lead to `position`. Returns false if no axis and
// channel can. Sets `pick` to 0.
bool invert_point(scatter_domain domain, vec3 position, vec3 normal, float u,
                  inout probe_numbers numbers) {
  float left = u * probe_pdf(domain, position, normal);
  bool found = false;
  [[dont_unroll]] for (uint technique = 0u; technique < 9u; ++technique) {
    float pdf = probe_technique_pdf(domain, technique / 3u, technique % 3u, position, normal);
    if (!(pdf > 0.0))
      continue;
    numbers.axis = technique / 3u;
    numbers.channel = technique % 3u;
    found = true;
    if (left < pdf)
      break;
    left -= pdf;
  }
  if (!found)
    return false;
  vec2 place = on_probe_disc(domain, numbers.axis, position - domain.position);
  float d = domain.d[numbers.channel];
  numbers.survival = clamp(1.0 - burley_cdf(length(place), d), 1.0 - probe_fraction, 1.0);
  float turn = place == vec2(0.0) ? 0.0 : atan(place.y, place.x) / (2.0 * restir_pi);
  numbers.angle = turn < 0.0 ? turn + 1.0 : turn;
  numbers.pick = 0.0;
  return true;
}

// Returns the number that picks the hit with this index.
float invert_pick(uint index, uint count, float u) { return (float(index) + u) / float(count); }

#endif
