#version 460
// Estimates the error of the picture from a few tiles, selected at random with known probabilities.
// In each tile, two independent estimates of the scattered light are made at four pixels, one per
// quarter. The mean product of the picture's differences from both is its squared error: the noise
// of the estimates has zero mean, so it adds no bias. passes/common/probe.hpp evaluates the result
// on the host.
// Each estimate importance-samples the profile as subsurface.burley does, on patches from depth.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "common/constants_math.glsl"
#include "common/subsurface_probe.bindings.glsl"
#include "common/environment.glsl"
#include "constants.glsl"
#include "common/counters.glsl"
#include "common/half.glsl"
#include "common/patch.glsl"
#include "common/pixel_light.glsl"
#include "common/probed_tile.glsl"
#include "common/profile.glsl"
#include "common/radius.glsl"
#include "common/sanitise.glsl"
#include "common/tap.glsl"

const uint lanes = 128u;
layout(local_size_x = 128, local_size_y = 1, local_size_z = 1) in;

const uint quarters = 4u, quarters_at_once = 2u;
const uint quarter_lanes = lanes / quarters_at_once;
const uint half_lanes = quarter_lanes / 2u; // of one estimate
const int taps_per_lane = 16;
const int taps = int(half_lanes) * taps_per_lane; // of one estimate

shared vec3 sums[lanes], weights[lanes];

uint class_at(int tile) { return classes_data[tile]; }

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

// Adds one sample of the light around `point`, whose radius has survival `u`.
void add_tap(scatter_point point, scatter_profile profile, float u, vec2 direction, inout vec3 sum,
             inout vec3 total) {
  radial_sample radial = profile_sample(profile, u);
  surface_tap tap;
  tap.at = vec2(point.pixel) + direction * radial.r / pixel_footprint(point.depth);
  tap.pixel = ivec2(round(clamp(tap.at, vec2(-1.0), vec2(frame.rect.zw))));
  tap.depth = depth_of(tap.pixel, point.id);
  if (tap.depth <= 0.0)
    return;
  surface_patch surface = patch_of(tap.pixel, point.id, tap.depth);
  tap.slope = surface.slope;
  vec3 weight = tap_weight(point, profile, tap, radial, surface.area);
  sum += weight * own_light(texel_of(tap.pixel));
  total += weight;
}

// Returns estimates, made by quarter_lanes invocations together, of the squared error of the
// exposed luminance at a pixel: of the picture, and of the light before scattering. `counts`:
// whether the pixel scatters. `copied`: it shows its own light.
vec2 squared_errors(ivec2 pixel, uint lane, bool copied, out bool counts) {
  ivec2 texel = texel_of(pixel);
  bool inside = inside_rect(pixel) && inside_bounds(pixel);
  uint id = inside ? texelFetch(material_image, texel, 0).r : 0u;
  float depth = id != 0u ? depth_of(pixel, id) : 0.0;
  float scale = has_scatter_scale() && inside
                    ? clean_scatter_scale(texelFetch(scatter_scale_image, texel, 0).r)
                    : 1.0;
  scatter_profile profile = find_profile(id, scale);
  counts = depth > 0.0 && projected_d(profile.d.w, depth) >= copy_below_d_px;
  vec3 light = vec3(0.0), weight = vec3(0.0);
  if (counts) {
    scatter_point point = scatter_point(pixel, id, depth, view_position(vec2(pixel), depth));
    vec3 random = unit_from_hash(
        pcg3d(uvec3(pixel, 2u * frame.frame_index + (lane / half_lanes & 1u)) ^
              uvec3(0u, 0x9e3779b9u, 0u)));
    for (int i = 0; i < taps_per_lane; ++i) {
      float tap = float(i * int(half_lanes) + int(lane % half_lanes));
      float angle = two_pi * random.y + golden_angle * tap;
      add_tap(point, profile, 1.0 - (tap + random.x) / float(taps), vec2(cos(angle), sin(angle)),
              light, weight);
    }
  }
  sums[lane] = light;
  weights[lane] = weight;
  barrier();
  for (uint stride = half_lanes / 2u; stride > 0u; stride /= 2u) {
    if (lane % half_lanes < stride) {
      sums[lane] += sums[lane + stride];
      weights[lane] += weights[lane + stride];
    }
    barrier();
  }
  if (!counts)
    return vec2(0.0);
  vec3 own = own_light(texel), direct = profile_direct(id);
  vec3 shown = has_scattered() && !copied ? texelFetch(scattered_image, texel, 0).rgb : own;
  vec2 products = vec2(1.0);
  for (uint estimate = 0u; estimate < 2u; ++estimate) {
    uint first = lane - lane % quarter_lanes + estimate * half_lanes;
    vec3 total = weights[first];
    vec3 found = sums[first] / max(total, vec3(1e-30));
    found = mix(own, found, vec3(greaterThan(min(total, profile.d.rgb), vec3(1e-30))));
    found = mix(found, own, direct);
    products *= frame.exposure *
                vec2(dot(shown - found, luminance_weights), dot(own - found, luminance_weights));
  }
  return products;
}

void main() {
  probed_tile selected;
  if (!find_probed_tile(settings.tiles, settings.interval, selected))
    return;
  uint lane = gl_LocalInvocationIndex;
  bool copied = class_of_tile(class_at(selected.tile)) != class_scatter;
  ivec2 first = 8 * position_of_tile(selected.tile);
  vec3 found = vec3(0.0); // of the invocation's quarters: errors of both kinds, pixels
  for (uint i = 0u; i < quarters; i += quarters_at_once) {
    uint quarter = i + lane / quarter_lanes;
    uvec3 place = pcg3d(uvec3(frame.frame_index, selected.tile, 2u + quarter));
    ivec2 pixel = first + 4 * ivec2(quarter % 2u, quarter / 2u) + ivec2(place.xy >> 30);
    bool counts;
    vec2 errors = squared_errors(pixel, lane, copied, counts);
    found += vec3(errors, counts ? 1.0 : 0.0);
    barrier();
  }
  sums[lane] = found;
  barrier();
  if (lane != 0u)
    return;
  found = (found + sums[quarter_lanes]) * selected.represented;
  uint place = atomicAdd(counters.probe_count, 1u);
  if (place < counters.probes.length()) {
    counters.probes[place] =
        uvec2(floatBitsToUint(found.x), floatBitsToUint(found.z));
    counters.probed_unscattered[place] = floatBitsToUint(found.y);
  }
}
