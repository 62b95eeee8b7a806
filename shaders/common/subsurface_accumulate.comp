#version 460
// Accumulates scattered light over frames, for hosts without their own temporal anti-aliasing.
// History keeps only the part of scattered light that the nearest pixels do not explain, relative
// to the mean light around. Noise is averaged; each frame's own sharp light is shown unchanged.
#extension GL_EXT_control_flow_attributes : require
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "common/constants_math.glsl"
#include "common/subsurface_accumulate.bindings.glsl"
#include "common/environment.glsl"
#include "common/tiles.glsl"
#include "common/half.glsl"
#include "common/radius.glsl"
#include "common/near_light.glsl"
#include "common/pixel_light.glsl"
#include "common/accumulate.glsl"
#include "common/reproject.glsl"

accumulated_light past_at(ivec2 pixel) {
  vec4 kept = texelFetch(past_image, previous_texel(pixel), 0);
  return accumulated_light(kept.rgb, kept.a);
}

vec2 surface_before(ivec2 pixel) {
  vec2 kept = texelFetch(place_image, previous_texel(pixel), 0).rg;
  return vec2(kept.r * mm_per_metre, kept.g);
}

// Reads history with cubic weights from the 4x4 texels around the place. Returns false unless all
// texels with a weight show the surface. One wait covers the independent loads of a row.
bool sharp_history(previous_position place, uint id, float tolerance, out accumulated_light found) {
  ivec2 first = ivec2(floor(place.pixel));
  vec2 part = place.pixel - vec2(first);
  vec4 across = catmull_rom(part.x), down = catmull_rom(part.y);
  ivec2 limit = frame.previous_rect.zw - 1;
  bool shown = true;
  [[dont_unroll]] for (int y = 0; y < 4; ++y) {
    float weight_y = y == 0 ? down.x : y == 1 ? down.y : y == 2 ? down.z : down.w;
    [[unroll]] for (int x = 0; x < 4; ++x) {
      ivec2 pixel = first + ivec2(x, y) - 1, inside = clamp(pixel, ivec2(0), limit);
      vec2 surface = surface_before(inside);
      bvec4 shows = bvec4(uint(surface.y) == id, abs(surface.x - place.depth) <= tolerance,
                          equal(pixel, inside));
      shown = across[x] * weight_y == 0.0 ? shown : all(bvec2(shown, all(shows)));
    }
  }
  found = accumulated_light(vec3(0.0), 0.0);
  if (!shown)
    return false;
  [[dont_unroll]] for (int y = 0; y < 4; ++y) {
    float weight_y = y == 0 ? down.x : y == 1 ? down.y : y == 2 ? down.z : down.w;
    [[unroll]] for (int x = 0; x < 4; ++x) {
      accumulated_light one = past_at(clamp(first + ivec2(x, y) - 1, ivec2(0), limit));
      float weight = across[x] * weight_y;
      // A texel without a weight may hold anything.
      found.light += weight == 0.0 ? vec3(0.0) : weight * one.light;
      found.count += weight == 0.0 ? 0.0 : weight * one.count;
    }
  }
  found.count = max(found.count, 0.0);
  return true;
}

// Reads history with bilinear weights from the texels that show the surface.
accumulated_light smooth_history(previous_position place, uint id, float tolerance) {
  history_taps taps = taps_around(place);
  ivec2 limit = frame.previous_rect.zw - 1;
  accumulated_light texels[4];
  [[unroll]] for (int i = 0; i < 4; ++i) {
    ivec2 pixel = clamp(tap_pixel(taps, i), ivec2(0), limit);
    texels[i] = past_at(pixel);
    if (!shows_surface(surface_before(pixel), place, id, tolerance))
      taps.weight[i] = 0.0;
  }
  taps = normalised_taps(taps);
  accumulated_light found = accumulated_light(vec3(0.0), 0.0);
  [[unroll]] for (int i = 0; i < 4; ++i)
    if (taps.weight[i] > 0.0) { // otherwise the texel may hold anything
      found.light += taps.weight[i] * texels[i].light;
      found.count += taps.weight[i] * texels[i].count;
    }
  return found;
}

// Returns the history of a pixel; count is 0 if the surface was not visible.
accumulated_light history_of(ivec2 pixel, float depth, uint id, float rise) {
  accumulated_light found = accumulated_light(vec3(0.0), 0.0);
  if (!history_usable())
    return found;
  previous_position place =
      has_velocity() ? reproject(vec2(pixel), depth,
                                 texelFetch(velocity_image, texel_of(pixel), 0).rgb)
                     : reproject(vec2(pixel), depth);
  float tolerance = depth_tolerance(place.depth, rise);
  if (!(place.depth > 0.0) || !all(lessThan(abs(place.pixel), vec2(reproject_largest_velocity))))
    return found;
  ivec2 first = ivec2(floor(place.pixel));
  if (place.pixel == vec2(first)) { // at rest, one texel has all of the weight
    ivec2 inside = clamp(first, ivec2(0), frame.previous_rect.zw - 1);
    accumulated_light one = past_at(inside);
    if (first == inside && shows_surface(surface_before(inside), place, id, tolerance))
      found = one;
    return found;
  }
  if (sharp_history(place, id, tolerance, found))
    return found;
  return smooth_history(place, id, tolerance);
}

// Values of this frame by pixel of the group and a ring of neighbours, where near_mean_light was.
// rgb: remainder of the light; a: profile, 0 if the pixel does not scatter.
int remainder_index(ivec2 local) { return (local.y + 1) * near_columns + local.x + 1; }
vec4 stored_remainder(int i) { return near_mean_light[i]; }
vec3 stored_scattered(int i) { return near_mean_light[i + near_columns * near_columns].rgb; }
void store_remainder(int i, vec4 remainder, vec3 scattered) {
  near_mean_light[i] = remainder;
  near_mean_light[i + near_columns * near_columns] = vec4(scattered, 0.0);
}

// Without the four corners, the ring has no more pixels than a subgroup of 32 has invocations.
const int ring_pixels = 32;
// Returns the i-th pixel of the ring around the group.
ivec2 ring_pixel(int i) {
  int along = i & 7, side = i >> 3;
  return side == 0   ? ivec2(along, -1)
         : side == 1 ? ivec2(along, 8)
         : side == 2 ? ivec2(-1, along)
                     : ivec2(8, along);
}

float scatter_scale_at(ivec2 texel) {
  return has_scatter_scale() ? clean_scatter_scale(texelFetch(scatter_scale_image, texel, 0).r)
                             : 1.0;
}

struct near_texel_values {
  uint id;
  float depth;
  vec3 light, scattered; // valid if id is not 0
};
near_texel_values load_near_texel(ivec2 pixel) {
  // All loads are unconditional, so that one wait covers them.
  ivec2 texel = texel_of(clamp(pixel, ivec2(0), frame.rect.zw - 1));
  near_texel_values values;
  values.id = profile_of(texelFetch(material_image, texel, 0).r);
  values.light = pixel_light(lighting_image, albedo_image, has_albedo(), settings.texturing, texel);
  values.scattered = texelFetch(scattered_image, texel, 0).rgb;
  values.depth = view_depth(texelFetch(depth_image, texel, 0).r);
  // Nothing is scattered beyond the bounds, so `scattered` is not written there.
  ivec2 low = max(frame.bounds.xy, ivec2(0));
  ivec2 high = min(frame.bounds.xy + frame.bounds.zw, frame.rect.zw) - 1;
  values.id = min(max(pixel, low), high) == pixel ? values.id : 0u;
  return values;
}

// Statistics over the 3x3 pixels that have the profile, except corners of the ring.
struct neighbourhood {
  vec3 mean, deviation;  // of the remainders
  vec3 minimum, largest; // of the scattered light
};
neighbourhood look_around(ivec2 local) {
  int at = remainder_index(local);
  vec4 own = stored_remainder(at);
  vec3 own_light = stored_scattered(at), sum = vec3(0.0), squares = vec3(0.0);
  float count = 1.0;
  neighbourhood around = neighbourhood(own.rgb, vec3(0.0), own_light, own_light);
  [[unroll]] for (int i = 0; i < 9; ++i) {
    if (i == 4)
      continue;
    int index = at + (i / 3 - 1) * near_columns + i % 3 - 1;
    vec4 other = stored_remainder(index);
    vec3 light = stored_scattered(index);
    bool same = other.a == own.a;
    // Differences to the pixel's own value avoid cancellation.
    vec3 way = same ? other.rgb - own.rgb : vec3(0.0);
    light = same ? light : own_light;
    sum += way;
    squares += way * way;
    count += same ? 1.0 : 0.0;
    around.minimum = min(around.minimum, light);
    around.largest = max(around.largest, light);
  }
  vec3 mean = sum / count;
  around.mean = own.rgb + mean;
  around.deviation = sqrt(max(squares / count - mean * mean, vec3(0.0)));
  return around;
}

// Returns the share of the 3x3 mean in what a pixel shows after `count` frames of history. It hides
// the noise of the first frames; only the pixel's own light enters its history.
float spatial_share(float count) {
  float frames = settings.disocclusion_frames;
  return frames > 0.0 ? max(1.0 - count / frames, 0.0) : 0.0;
}

struct shown_and_kept {
  vec3 shown;
  accumulated_light kept;
};
shown_and_kept with_history(accumulated_light history, vec3 light, near_field near, ivec2 local) {
  vec3 now = stored_remainder(remainder_index(local)).rgb;
  bvec3 lit = greaterThan(near.local_mean, vec3(accumulate_min_mean));
  if (!any(lit)) // keeps history until light comes back
    return shown_and_kept(light, history);
  now = mix(history.light, now, lit);
  if (!can_be_kept(now))
    return shown_and_kept(light, accumulated_light(vec3(0.0), 0.0));
  vec3 limit = vec3(accumulate_largest_remainder);
  float spatial = spatial_share(history.count);
  if (!(history.count > 0.0) && !(spatial > 0.0))
    return shown_and_kept(light, accumulated_light(now, 1.0));
  history.light = clamp(history.light, -limit, limit);
  bool clips = settings.clip > 0.0 && history.count > 0.0;
  bool looks = clips || spatial > 0.0;
  neighbourhood around;
  if (looks)
    around = look_around(local);
  if (clips) {
    history = clip_to_neighbours(history, mix(history.light, around.mean, lit), around.deviation,
                                 settings.clip);
  }
  accumulated_light sum = add_frame(history, now, settings.weight);
  vec3 remainder =
      spatial > 0.0 ? mix(sum.light, clamp(around.mean, -limit, limit), spatial) : sum.light;
  vec3 shown = mix(light, light_of_remainder(remainder, near.light, near.local_mean), lit);
  if (looks)
    shown = clamp(shown, around.minimum, around.largest);
  return shown_and_kept(shown, sum);
}

void store_pixel(ivec2 texel, shown_and_kept now, float depth, uint id) {
  imageStore(accumulated_image, texel, vec4(round_to_half(now.shown), 1.0));
  imageStore(past_out_image, texel, round_to_half(vec4(now.kept.light, now.kept.count)));
  imageStore(place_out_image, texel,
             round_to_half(vec4(depth / mm_per_metre, float(id), 0.0, 0.0)));
}

void main() {
  uint tile = listed_tile();
  if (tile >= tiles_data[0]) // for all invocations of the group
    return;
  ivec2 pixel;
  bool copy_only;
  bool listed = pixel_of_tile(tiles_data[1u + tile], pixel, copy_only);
  ivec2 texel = texel_of(pixel);
  if (copy_only) {
    if (listed)
      store_pixel(texel,
                  shown_and_kept(texelFetch(scattered_image, texel, 0).rgb,
                                 accumulated_light(vec3(0.0), 0.0)),
                  view_depth(texelFetch(depth_image, texel, 0).r), 0u);
    return;
  }
  ivec2 local = ivec2(gl_LocalInvocationID.xy), first = pixel - local;
  int invocation = int(gl_LocalInvocationIndex);
  bool has_ring = invocation < ring_pixels;
  ivec2 ring = ring_pixel(invocation & (ring_pixels - 1));
  ivec2 limit = frame.rect.zw - 1, ring_texel = texel_of(clamp(first + ring, ivec2(0), limit));
  near_texel_values values[near_texels_each];
  [[unroll]] for (int k = 0; k < near_texels_each; ++k)
    values[k] = load_near_texel(first + near_texel(k));
  float scale = scatter_scale_at(texel_of(min(pixel, limit)));
  float ring_scale = scatter_scale_at(ring_texel);
  vec3 ring_scattered = texelFetch(scattered_image, ring_texel, 0).rgb;
  vec3 lights[near_texels_each];
  [[unroll]] for (int k = 0; k < near_texels_each; ++k) {
    bool known = values[k].id != 0u;
    lights[k] = known ? values[k].light : vec3(0.0);
    store_near_texel(near_texel(k), values[k].id, values[k].depth, lights[k],
                     known ? values[k].scattered : vec3(0.0));
  }
  float rise = finish_near_light(lights);
  uint id = values[0].id;
  float depth = values[0].depth;
  vec3 light = values[0].scattered;
  near_field near;
  [[dont_unroll]] for (int k = has_ring ? 0 : 1; k < 2; ++k) { // ring, own
    ivec2 at = k == 0 ? ring : local;
    uint profile_id = uint(near_surface_at(at).y);
    vec3 scattered = k == 0 ? ring_scattered : light;
    vec4 remainder = vec4(0.0);
    if (profile_id != 0u) {
      scatter_profile profile = find_profile(profile_id, k == 0 ? ring_scale : scale);
      near = find_near_field(at, profile, profile_direct(profile_id));
      remainder = vec4(remainder_of(scattered, near.light, near.local_mean), float(profile_id));
    }
    store_remainder(remainder_index(at), remainder, scattered);
  }
  if (invocation < 4) // corners of the ring
    store_remainder(remainder_index(9 * ivec2(invocation & 1, invocation >> 1) - 1), vec4(0.0),
                    vec3(0.0));
  barrier();
  if (!listed)
    return;
  shown_and_kept now = shown_and_kept(light, accumulated_light(vec3(0.0), 0.0));
  bool scatters = id != 0u && depth > 0.0;
  if (scatters)
    now = with_history(history_of(pixel, depth, id, rise), light, near, local);
  store_pixel(texel, now, depth, scatters ? id : 0u);
}
