#version 460
// Estimates the error of the picture from a few tiles, selected at random with known probabilities.
// In each tile, the reference is computed at four pixels, one per quarter. The tiles are divided
// into runs of 64; every n-th run, from a random start, provides one of its tiles with subsurface.
// passes/common/probe.hpp evaluates the result on the host.
// The reference is that of passes/common/reference/reference.hpp in fp32:
//   L_c(p) = sum_q K_c a_q B_c(q) / sum_q K_c a_q
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "common/constants_math.glsl"
#include "common/subsurface_probe.bindings.glsl"
#include "common/environment.glsl"
#include "constants.glsl"
#include "common/counters.glsl"
#include "common/half.glsl"
#include "common/hash.glsl"
#include "common/patch.glsl"
#include "common/pixel_light.glsl"
#include "common/profile.glsl"
#include "common/radius.glsl"
#include "common/sanitise.glsl"
#include "common/tile_packing.glsl"

const uint lanes = 64u;
layout(local_size_x = 64, local_size_y = 1, local_size_z = 1) in;

const uint quarters = 4u;
// Within near_px pixels the kernel is averaged over 8x8 points of a patch.
const int near_px = 4, near_points = 8;
// A midpoint sum over cells of side h with the pole of 1/r at a shared corner of four cells misses
// this factor times h of the integral. The factor is the regularised sum over (i + 1/2, j + 1/2) of
// 1/r: -4 (sqrt 2 - 1) zeta(1/2) beta(1/2).
const float pole_lack = 1.6155;

shared uint listed[lanes];   // tiles of the run with subsurface, in order
shared uint listed_count;
shared vec3 sums[lanes], weights[lanes];

// Returns the depth of a pixel of the profile in mm, else 0.
float depth_of(ivec2 pixel, uint id) {
  if (!inside_rect(pixel) || !inside_bounds(pixel) ||
      texelFetch(material_image, texel_of(pixel), 0).r != id)
    return 0.0;
  return view_depth(texelFetch(depth_image, texel_of(pixel), 0).r);
}

surface_patch patch_of(ivec2 pixel, uint id, float depth) {
  return build_patch(
      pixel, depth,
      patch_neighbours(vec2(depth_of(pixel - ivec2(1, 0), id), depth_of(pixel - ivec2(0, 1), id)),
                       vec2(depth_of(pixel + ivec2(1, 0), id), depth_of(pixel + ivec2(0, 1), id))));
}

vec3 own_light(ivec2 texel) {
  return pixel_light(lighting_image, albedo_image, has_albedo(), settings.texturing, texel);
}

// Returns the intersection of the patch's plane with the ray through a point `offset` pixels from
// the centre of `pixel`.
vec3 patch_point(ivec2 pixel, float depth, vec2 slope, vec2 offset) {
  float there = max(depth + dot(slope, offset * pixel_footprint(depth)), 0.1 * depth);
  return view_position(vec2(pixel) + offset, there);
}

// Returns K_c of a patch `q` at its distance from `p`: 2 pi times the profile, averaged over points
// of the patch.
vec3 kernel(scatter_profile profile, vec3 p, ivec2 pixel, ivec2 q, float depth,
            surface_patch surface) {
  ivec2 apart = abs(q - pixel);
  if (max(apart.x, apart.y) > near_px)
    return profile_falloff(profile,
                           max(length(patch_point(q, depth, surface.slope, vec2(0.0)) - p), 1e-6));
  vec3 sum = vec3(0.0);
  float step = 1.0 / float(near_points);
  for (int i = 0; i < near_points * near_points; ++i) {
    vec2 offset = (vec2(i % near_points, i / near_points) + 0.5) * step - 0.5;
    sum += profile_falloff(profile,
                           max(length(patch_point(q, depth, surface.slope, offset) - p), 1e-6));
  }
  sum *= step * step;
  if (q == pixel) { // adds the part of the pole that the sum misses
    vec2 sides = pixel_footprint(depth);
    float side = sqrt(sides.x * sides.y * surface.area), small = 1e-3 * profile.d.w;
    sum += pole_lack * step / side * small * profile_falloff(profile, small);
  }
  return sum;
}

// Returns the squared error of the exposed luminance at a pixel, computed by all invocations
// together; a negative value means that the pixel does not count. `copied`: the pixel shows its own
// light.
float squared_error(ivec2 pixel, uint lane, bool copied) {
  ivec2 texel = texel_of(pixel);
  bool inside = inside_rect(pixel) && inside_bounds(pixel);
  uint id = inside ? texelFetch(material_image, texel, 0).r : 0u;
  float depth = id != 0u ? depth_of(pixel, id) : 0.0;
  float scale = has_scatter_scale() && inside
                    ? clean_scatter_scale(texelFetch(scatter_scale_image, texel, 0).r)
                    : 1.0;
  scatter_profile profile = find_profile(id, scale);
  float reach = depth > 0.0 ? uniform_reach_d * projected_d(profile.d.w, depth) : 0.0;
  bool counts =
      depth > 0.0 && reach >= uniform_reach_d * copy_below_d_px && reach <= float(probe_max_reach);
  vec3 light = vec3(0.0), weight = vec3(0.0);
  if (counts) {
    vec3 p = view_position(vec2(pixel), depth);
    int radius = int(ceil(reach)), side = 2 * radius + 1;
    float reach_mm = uniform_reach_d * profile.d.w;
    for (int i = int(lane); i < side * side; i += int(lanes)) {
      ivec2 q = pixel + ivec2(i % side, i / side) - radius;
      float there = depth_of(q, id);
      if (there <= 0.0 || distance(view_position(vec2(q), there), p) > reach_mm)
        continue;
      surface_patch surface = patch_of(q, id, there);
      vec2 sides = pixel_footprint(there);
      vec3 k = kernel(profile, p, pixel, q, there, surface) * (sides.x * sides.y * surface.area);
      weight += k;
      light += k * own_light(texel_of(q));
    }
  }
  sums[lane] = light;
  weights[lane] = weight;
  barrier();
  for (uint stride = lanes / 2u; stride > 0u; stride /= 2u) {
    if (lane < stride) {
      sums[lane] += sums[lane + stride];
      weights[lane] += weights[lane + stride];
    }
    barrier();
  }
  if (!counts)
    return -1.0;
  vec3 own = own_light(texel), direct = profile_direct(id);
  vec3 reference = mix(sums[0] / max(weights[0], vec3(1e-30)), own, direct);
  reference = mix(own, reference, vec3(greaterThan(profile.d.rgb, vec3(0.0))));
  vec3 shown = has_scattered() && !copied ? texelFetch(scattered_image, texel, 0).rgb : own;
  float off = dot(shown - reference, luminance_weights) * frame.exposure;
  return off * off;
}

void main() {
  uint lane = gl_LocalInvocationIndex, run = gl_WorkGroupID.x, runs = gl_NumWorkGroups.x;
  // Fraction of the runs that are selected, which is the probability of selecting this run.
  float fraction = min(float(settings.tiles) / float(runs), 1.0);
  float start = unit_from_hash(pcg3d(uvec3(frame.frame_index, 0u, 0u))).x;
  if (fraction < 1.0 &&
      floor((float(run) + 1.0) * fraction + start) <= floor(float(run) * fraction + start))
    return;
  uint tile = run * lanes + lane;
  listed[lane] =
      tile < uint(frame.tiles.x * frame.tiles.y) ? class_of_tile(classes_data[tile]) : class_none;
  barrier();
  if (lane == 0u) {
    listed_count = 0u;
    for (uint i = 0u; i < lanes; ++i)
      if (listed[i] != class_none)
        listed[listed_count++] = run * lanes + i;
  }
  barrier();
  uint count = listed_count;
  if (count == 0u)
    return;
  uvec3 random_bits = pcg3d(uvec3(frame.frame_index, run, 1u));
  uint chosen = listed[min(uint(unit_from_hash(random_bits).x * float(count)), count - 1u)];
  ivec2 first = 8 * ivec2(chosen % uint(frame.tiles.x), chosen / uint(frame.tiles.x));
  float errors = 0.0, pixels = 0.0;
  for (uint quarter = 0u; quarter < quarters; ++quarter) {
    uvec3 place = pcg3d(uvec3(frame.frame_index, chosen, 2u + quarter));
    ivec2 pixel = first + 4 * ivec2(quarter % 2u, quarter / 2u) + ivec2(place.xy >> 30);
    float squared =
        squared_error(pixel, lane, class_of_tile(classes_data[chosen]) != class_scatter);
    barrier();
    if (squared >= 0.0) {
      errors += squared;
      pixels += 1.0;
    }
  }
  if (lane != 0u)
    return;
  float stands_for = float(count) / fraction; // number of tiles that the selected tile represents
  uint place = atomicAdd(counters.probe_count, 1u);
  if (place < counters.probes.length()) {
    counters.probes[place] =
        uvec2(floatBitsToUint(stands_for * errors), floatBitsToUint(stands_for * pixels));
  }
}
