#version 460
// Estimates the error of the picture from a few tiles, selected at random with known probabilities.
// In each tile, four independent estimates of the scattered light are made at four pixels, one per
// quarter. The mean product of the picture's differences from two of them is its squared error: the
// noise of the estimates has zero mean, so it adds no bias. The same is done with the light before
// scattering, and with the result that subsurface.separable would have. passes/common/probe.hpp
// evaluates the results on the host.
// Each estimate importance-samples the profile as subsurface.burley does, on patches from depth.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
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
#include "separable/separable_at_pixel.glsl"
#include "separable/surface.glsl"

const uint lanes = 128u;
layout(local_size_x = 128, local_size_y = 1, local_size_z = 1) in;

const uint quarters = 4u, quarters_at_once = 2u;
const uint quarter_lanes = lanes / quarters_at_once;
const uint estimates = 4u;
const uint estimate_lanes = quarter_lanes / estimates; // of one estimate
const int taps_per_lane = 16;
const int taps = int(estimate_lanes) * taps_per_lane; // of one estimate
const float min_others = 0.25; // fraction of all weights by which a product is normalised
const uint column_lanes = lanes / quarters; // compute the result of subsurface.separable at a pixel

shared vec3 sums[lanes], weights[lanes];
shared vec3 separable_light[quarters]; // negative: the pixel's own light

uint class_at(int tile) { return classes_data[tile]; }

// Returns the depth of a pixel of the profile in mm, else 0.
float depth_of(ivec2 pixel, uint id) {
  if (!inside_rect(pixel) || !inside_bounds(pixel) ||
      profile_of(texelFetch(material_image, texel_of(pixel), 0).r) != id)
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
  vec3 weight = tap_weight(point, profile, tap, radial, surface.footprints);
  sum += weight * own_light(texel_of(tap.pixel));
  total += weight;
}

uint profile_at(ivec2 pixel) {
  bool inside = inside_rect(pixel) && inside_bounds(pixel);
  return inside ? profile_of(texelFetch(material_image, texel_of(pixel), 0).r) : 0u;
}

float scale_at(ivec2 texel) {
  return has_scatter_scale() ? clean_scatter_scale(texelFetch(scatter_scale_image, texel, 0).r)
                             : 1.0;
}

// For separable/separable_at_pixel.glsl, inside the rectangle.
vec4 light_at(ivec2 texel) {
  uint id = profile_at(texel - frame.rect.xy);
  return id != 0u ? vec4(round_to_half(own_light(texel)), stored_profile(id)) : vec4(0.0);
}
float depth_at(ivec2 texel) {
  bool listed = profile_at(texel - frame.rect.xy) != 0u;
  float depth = listed ? view_depth(texelFetch(depth_image, texel, 0).r) : 0.0;
  return depth > 0.0 ? depth : no_surface();
}
float d_at(ivec2 texel, uint profile) { return profiles[profile].d_mm.w * scale_at(texel); }

// Adds sums and weights of each `count` invocations; the first one of them has the results.
void add_lanes(uint lane, uint count) {
  barrier();
  for (uint stride = count / 2u; stride > 0u; stride /= 2u) {
    if (lane % count < stride) {
      sums[lane] += sums[lane + stride];
      weights[lane] += weights[lane + stride];
    }
    barrier();
  }
}

// Returns the pixel of a quarter of the tile at `first` in which this frame is probed.
ivec2 probed_pixel(probed_tile selected, ivec2 first, uint quarter) {
  uvec3 place = pcg3d(uvec3(frame.frame_index, selected.tile, 2u + quarter));
  return first + 4 * ivec2(quarter % 2u, quarter / 2u) + ivec2(place.xy >> 30);
}

// Computes separable_light. `pixel`: of the invocation's quarter.
void scatter_separably(ivec2 pixel, uint lane, bool copied) {
  uint row = lane % column_lanes, id = profile_at(pixel);
  column_part part;
  bool scatters = false;
  sums[lane] = vec3(0.0);
  weights[lane] = vec3(0.0);
  if (id != 0u && !copied) {
    ivec2 texel = texel_of(pixel);
    scatters = scatters_at(min(id, 255u), d_at(texel, min(id, 255u)), depth_at(texel));
  }
  if (scatters && row < column_pixels) {
    part = scatter_column(pixel, row);
    sums[lane] = part.sums.light;
    weights[lane] = part.sums.weight;
  }
  add_lanes(lane, column_lanes);
  if (row == 0u && scatters)
    separable_light[lane / column_lanes] =
        complete_column(part, tap_sums(sums[lane], weights[lane]));
  else if (row == 0u)
    separable_light[lane / column_lanes] = vec3(-1.0);
  barrier();
}

// Returns the differences of luminance between the picture, the light before scattering, and
// `separable`, and one estimate: weights and sums at `place`, times `scale`.
vec3 differences(uint place, vec3 scale, vec3 scatters, vec3 direct, vec3 own, vec3 shown,
                 vec3 separable) {
  vec3 weight = mix(vec3(1.0), scale * weights[place], scatters);
  vec3 light = mix(own, scale * sums[place], scatters);
  light = mix(light, own * weight, direct);
  return vec3(dot(shown * weight - light, luminance_weights),
              dot(own * weight - light, luminance_weights),
              dot(separable * weight - light, luminance_weights));
}

// Returns estimates, made by quarter_lanes invocations together, of the squared error of the
// exposed luminance at a pixel: of the picture, of the light before scattering, and of `separable`.
// `counts`: whether the pixel scatters. `copied`: it shows its own light.
vec3 squared_errors(ivec2 pixel, uint lane, bool copied, vec3 separable, out bool counts) {
  ivec2 texel = texel_of(pixel);
  uint id = profile_at(pixel);
  float depth = id != 0u ? depth_of(pixel, id) : 0.0;
  scatter_profile profile = find_profile(id, id != 0u ? scale_at(texel) : 1.0);
  counts = depth > 0.0 && projected_d(profile.d.w, depth) >= copy_below_d_px;
  vec3 light = vec3(0.0), weight = vec3(0.0);
  if (counts) {
    scatter_point point = scatter_point(pixel, id, depth, view_position(vec2(pixel), depth));
    vec3 random = unit_from_hash(
        pcg3d(uvec3(pixel, estimates * frame.frame_index + lane / estimate_lanes % estimates) ^
              uvec3(0u, 0x9e3779b9u, 0u)));
    for (int i = 0; i < taps_per_lane; ++i) {
      float tap = float(i * int(estimate_lanes) + int(lane % estimate_lanes));
      float angle = two_pi * random.y + golden_angle * tap;
      add_tap(point, profile, 1.0 - (tap + random.x) / float(taps), vec2(cos(angle), sin(angle)),
              light, weight);
    }
  }
  sums[lane] = light;
  weights[lane] = weight;
  add_lanes(lane, estimate_lanes);
  if (!counts)
    return vec3(0.0);
  vec3 own = own_light(texel), direct = profile_direct(id);
  vec3 shown = has_scattered() && !copied ? texelFetch(scattered_image, texel, 0).rgb : own;
  if (separable.r < 0.0)
    separable = own;
  uint first = lane - lane % quarter_lanes;
  vec3 total = vec3(0.0);
  for (uint e = 0u; e < estimates; ++e)
    total += weights[first + e * estimate_lanes];
  // The other channels do not scatter.
  vec3 scatters = vec3(greaterThan(min(total, profile.d.rgb), vec3(1e-30)));
  // Products of differences that are linear in the sums of two estimates, normalised by the sums of
  // the two others: a ratio of sums of the same estimate would have a bias.
  vec3 products = vec3(0.0);
  [[dont_unroll]] for (uint pair = 0u; pair < 6u; ++pair) {
    uint a = pair < 3u ? 0u : (pair < 5u ? 1u : 2u);
    uint b = pair < 3u ? pair + 1u : (pair < 5u ? pair - 1u : 3u);
    uint place_a = first + a * estimate_lanes, place_b = first + b * estimate_lanes;
    vec3 others = total - weights[place_a] - weights[place_b]; // half of the total on average
    vec3 scale = 2.0 / max(max(others, min_others * total), vec3(1e-30));
    products += differences(place_a, scale, scatters, direct, own, shown, separable) *
                differences(place_b, scale, scatters, direct, own, shown, separable);
  }
  return products * (frame.exposure * frame.exposure / 6.0);
}

void main() {
  probed_tile selected;
  if (!find_probed_tile(settings.tiles, settings.interval, selected))
    return;
  uint lane = gl_LocalInvocationIndex;
  uint tile_class = class_of_tile(class_at(selected.tile));
  bool copied = tile_class != class_scatter;
  ivec2 first = 8 * position_of_tile(selected.tile);
  // The separable technique would also run in tiles that a budget leaves out.
  scatter_separably(probed_pixel(selected, first, lane / column_lanes), lane,
                    tile_class == class_uniform);
  vec3 found = vec3(0.0); // errors of the invocation's quarters
  float pixels = 0.0;
  for (uint i = 0u; i < quarters; i += quarters_at_once) {
    uint quarter = i + lane / quarter_lanes;
    bool counts;
    found += squared_errors(probed_pixel(selected, first, quarter), lane, copied,
                            separable_light[quarter], counts);
    pixels += counts ? 1.0 : 0.0;
    barrier();
  }
  sums[lane] = found;
  weights[lane] = vec3(pixels);
  barrier();
  if (lane != 0u)
    return;
  found = (found + sums[quarter_lanes]) * selected.represented;
  pixels = (pixels + weights[quarter_lanes].x) * selected.represented;
  uint place = atomicAdd(counters.probe_count, 1u);
  if (place < counters.probes.length()) {
    counters.probes[place] = uvec2(floatBitsToUint(found.x), floatBitsToUint(pixels));
    counters.probed_unscattered[place] = floatBitsToUint(found.y);
    counters.probed_separable[place] = floatBitsToUint(found.z);
  }
}
