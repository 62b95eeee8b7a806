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

history_taps find_history(previous_place place, uint id, float tolerance) {
  history_taps taps = taps_around(place);
  for (int i = 0; i < 4; ++i)
    if (taps.weight[i] > 0.0 &&
        !shows_surface(surface_before(tap_pixel(taps, i)), place, id, tolerance))
      taps.weight[i] = 0.0;
  return normalised_taps(taps);
}

// Reads history with cubic weights from the 4x4 texels around the place. Returns false unless all
// of them show the surface.
bool sharp_history(previous_place place, uint id, float tolerance, out accumulated_light found) {
  ivec2 first = ivec2(floor(place.pixel));
  vec2 part = place.pixel - vec2(first);
  vec4 across = catmull_rom(part.x), down = catmull_rom(part.y);
  found = accumulated_light(vec3(0.0), 0.0);
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 4; ++x) {
      ivec2 pixel = first + ivec2(x, y) - 1;
      float weight = across[x] * down[y];
      if (weight == 0.0)
        continue;
      vec2 surface = inside_previous(pixel) ? surface_before(pixel) : vec2(0.0);
      if (!shows_surface(surface, place, id, tolerance))
        return false;
      accumulated_light one = past_at(pixel);
      found.light += weight * one.light;
      found.count += weight * one.count;
    }
  found.count = max(found.count, 0.0);
  return true;
}

// Returns the history of a pixel; count is 0 if the surface was not visible.
accumulated_light history_of(ivec2 pixel, float depth, uint id, float rise) {
  accumulated_light found = accumulated_light(vec3(0.0), 0.0);
  if (!(history_usable() && depth > 0.0))
    return found;
  previous_place place =
      has_velocity() && depth > 0.0
          ? place_before(vec2(pixel), depth, texelFetch(velocity_image, texel_of(pixel), 0).rgb)
          : place_before(vec2(pixel), depth);
  float tolerance = depth_tolerance(place.depth, rise);
  history_taps taps = find_history(place, id, tolerance);
  if (taps.weight == vec4(0.0) || sharp_history(place, id, tolerance, found))
    return found;
  found = accumulated_light(vec3(0.0), 0.0);
  for (int i = 0; i < 4; ++i)
    if (taps.weight[i] > 0.0) {
      accumulated_light one = past_at(tap_pixel(taps, i));
      found.light += taps.weight[i] * one.light;
      found.count += taps.weight[i] * one.count;
    }
  return found;
}

// Reads the texels around the group with first pixel `first`, each once. Every invocation of the
// group must call this.
void share_near_light(ivec2 first) {
  for (int i = int(gl_LocalInvocationIndex); i < near_texels; i += 64) {
    ivec2 pixel = near_pixel(first, i), texel = texel_of(pixel);
    // Nothing is scattered beyond the bounds, so `scattered` is not written there.
    uint id =
        inside_rect(pixel) && inside_bounds(pixel) ? texelFetch(material_image, texel, 0).r : 0u;
    vec3 light = vec3(0.0), scattered = vec3(0.0);
    float depth = 0.0;
    if (id != 0u) {
      light = pixel_light(lighting_image, albedo_image, has_albedo(), settings.texturing, texel);
      scattered = texelFetch(scattered_image, texel, 0).rgb;
      depth = view_depth(texelFetch(depth_image, texel, 0).r);
    }
    store_near_texel(i, id, depth, light, scattered);
  }
  finish_near_light();
}

// Remainders of this frame's light, by pixel of the group and a ring of neighbours.
shared vec3 shared_remainders[near_columns * near_columns];
int remainder_index(ivec2 local) { return (local.y + 1) * near_columns + local.x + 1; }

near_field share_remainder(ivec2 first, ivec2 local) {
  int index = near_index(local);
  if (near_profile[index] == 0u || !(near_depth[index] > 0.0))
    return near_field(vec3(0.0), vec3(0.0));
  ivec2 texel = texel_of(first + local);
  float scale =
      has_scatter_scale() ? clean_scatter_scale(texelFetch(scatter_scale_image, texel, 0).r) : 1.0;
  uint id = near_profile[index];
  near_field near = find_near_field(local, find_profile(id, scale), profile_direct(id));
  shared_remainders[remainder_index(local)] =
      remainder_of(texelFetch(scattered_image, texel, 0).rgb, near.light, near.local_mean);
  return near;
}

// Returns the i-th of the 36 pixels around the group.
ivec2 ring_pixel(int i) {
  return i < 10   ? ivec2(i - 1, -1)
         : i < 20 ? ivec2(i - 11, 8)
         : i < 28 ? ivec2(-1, i - 20)
                  : ivec2(8, i - 28);
}

// Statistics over the 3x3 pixels that have the profile.
struct neighbourhood {
  vec3 mean, deviation; // of the remainders
  vec3 minimum, largest;  // of the scattered light
};
neighbourhood look_around(ivec2 first, ivec2 local, vec3 own_light) {
  vec3 own = shared_remainders[remainder_index(local)], sum = vec3(0.0), squares = vec3(0.0);
  float count = 0.0;
  neighbourhood around = neighbourhood(own, vec3(0.0), own_light, own_light);
  for (int y = -1; y <= 1; ++y)
    for (int x = -1; x <= 1; ++x) {
      ivec2 other = local + ivec2(x, y);
      int index = near_index(other);
      if (near_profile[index] != near_profile[near_index(local)] || !(near_depth[index] > 0.0))
        continue;
      // Differences to the pixel's own value avoid cancellation.
      vec3 way = shared_remainders[remainder_index(other)] - own;
      vec3 light = texelFetch(scattered_image, texel_of(first + other), 0).rgb;
      sum += way;
      squares += way * way;
      count += 1.0;
      around.minimum = min(around.minimum, light);
      around.largest = max(around.largest, light);
    }
  vec3 mean = sum / max(count, 1.0);
  around.mean = own + mean;
  around.deviation = sqrt(max(squares / max(count, 1.0) - mean * mean, vec3(0.0)));
  return around;
}

struct shown_and_kept {
  vec3 shown;
  accumulated_light kept;
};
shown_and_kept with_history(accumulated_light history, vec3 light, near_field near, vec3 now,
                            neighbourhood around) {
  bvec3 lit = greaterThan(near.local_mean, vec3(accumulate_min_mean));
  if (!any(lit)) // keeps history until light comes back
    return shown_and_kept(light, history);
  now = mix(history.light, now, lit);
  if (!can_be_kept(now))
    return shown_and_kept(light, accumulated_light(vec3(0.0), 0.0));
  if (!(history.count > 0.0))
    return shown_and_kept(light, accumulated_light(now, 1.0));
  history.light =
      clamp(history.light, vec3(-accumulate_largest_remainder), vec3(accumulate_largest_remainder));
  if (settings.clip > 0.0)
    history = clip_to_neighbours(history, mix(history.light, around.mean, lit), around.deviation,
                                 settings.clip);
  accumulated_light sum = add_frame(history, now, settings.weight);
  vec3 shown = mix(light, light_of_remainder(sum.light, near.light, near.local_mean), lit);
  return shown_and_kept(settings.clip > 0.0 ? clamp(shown, around.minimum, around.largest) : shown,
                        sum);
}

void main() {
  uint tile = listed_tile();
  ivec2 pixel = ivec2(0);
  bool copy_only = false;
  bool listed = tile < tiles_data[0] && pixel_of_tile(tiles_data[1u + tile], pixel, copy_only);
  ivec2 local = ivec2(gl_LocalInvocationID.xy), first = pixel - local, texel = texel_of(pixel);
  share_near_light(first);
  near_field near;
  [[dont_unroll]] for (int i = int(gl_LocalInvocationIndex); i < 64 + 36; i += 64) {
    near_field one = share_remainder(first, i < 64 ? local : ring_pixel(i - 64));
    if (i < 64)
      near = one;
  }
  barrier();
  if (!listed)
    return;
  uint id = texelFetch(material_image, texel, 0).r;
  float depth = view_depth(texelFetch(depth_image, texel, 0).r);
  vec3 light = texelFetch(scattered_image, texel, 0).rgb;
  shown_and_kept now = shown_and_kept(light, accumulated_light(vec3(0.0), 0.0));
  int own = near_index(local);
  bool scatters = near_profile[own] != 0u && !copy_only && near_depth[own] > 0.0;
  if (scatters)
    now = with_history(history_of(pixel, depth, id, length(near_rise(own))), light, near,
                       shared_remainders[remainder_index(local)], look_around(first, local, light));
  imageStore(accumulated_image, texel, vec4(round_to_half(now.shown), 1.0));
  imageStore(past_out_image, texel, round_to_half(vec4(now.kept.light, now.kept.count)));
  imageStore(place_out_image, texel,
             round_to_half(vec4(depth / mm_per_metre, scatters ? float(id) : 0.0, 0.0, 0.0)));
}
