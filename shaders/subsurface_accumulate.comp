#version 460
// Scattered light over frames, for hosts without anti-aliasing of their own: what a surface showed before is found again,
// made as much brighter as its tile became, drawn towards what is around it now, and mixed with this frame's.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "subsurface_accumulate.bindings.glsl"
#include "environment.glsl"
#include "tiles.glsl"
#include "half.glsl"
#include "radius.glsl"
#include "accumulate.glsl"
vec2 surface_before(ivec2 pixel);
#include "reproject.glsl"

const float mm_per_metre = 1000.0;

accumulated_light past_at(ivec2 pixel) {
  vec4 kept = texelFetch(past_image, previous_texel(pixel), 0);
  return accumulated_light(kept.rgb, kept.a);
}

vec2 surface_before(ivec2 pixel) {
  vec2 kept = texelFetch(place_image, previous_texel(pixel), 0).rg;
  return vec2(kept.r * mm_per_metre, kept.g);
}

bool is_surface(ivec2 pixel, uint id, float depth, float tolerance) {
  vec2 surface = inside_previous(pixel) ? surface_before(pixel) : vec2(0.0);
  return uint(surface.y) == id && abs(surface.x - depth) <= tolerance;
}

// Of the 4x4 texels around the place, if all of them show the surface; else false.
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
      if (!is_surface(pixel, id, place.depth, tolerance))
        return false;
      accumulated_light one = past_at(pixel);
      found.light += weight * one.light;
      found.count += weight * one.count;
    }
  found = accumulated_light(max(found.light, vec3(0.0)), max(found.count, 0.0));
  return true;
}

// count 0 where the surface was not to be seen.
accumulated_light history_of(ivec2 pixel, float depth, uint id, float rise) {
  accumulated_light found = accumulated_light(vec3(0.0), 0.0);
  if (!(history_usable() && depth > 0.0))
    return found;
  previous_place place = has_velocity() && depth > 0.0
                             ? place_before(vec2(pixel), depth, texelFetch(velocity_image, texel_of(pixel), 0).rgb)
                             : place_before(vec2(pixel), depth);
  float tolerance = depth_tolerance(place.depth, rise);
  history_taps taps = find_history(place, id, tolerance);
  if (taps.weight == vec4(0.0) || sharp_history(place, id, tolerance, found))
    return found;
  found = accumulated_light(vec3(0.0), 0.0);
  for (int i = 0; i < 4; ++i)
    if (taps.weight[i] > 0.0) {
      accumulated_light one = past_at(taps.first + ivec2(i & 1, i >> 1));
      found.light += taps.weight[i] * one.light;
      found.count += taps.weight[i] * one.count;
    }
  return found;
}

struct neighbourhood {
  vec3 mean, deviation; // of light, over those of 3x3 pixels that have the profile
  float rise;           // change of depth over a pixel, mm: the smaller of both sides, so that edges do not count
};

neighbourhood look_around(ivec2 pixel, uint id, float depth) {
  vec3 sum = vec3(0.0), squares = vec3(0.0);
  float count = 0.0;
  const float none = 1e30;
  vec2 least_step = vec2(none);
  vec3 own = texelFetch(scattered_image, texel_of(pixel), 0).rgb;
  for (int y = -1; y <= 1; ++y)
    for (int x = -1; x <= 1; ++x) {
      ivec2 q = pixel + ivec2(x, y), texel = texel_of(q);
      if (!inside_rect(q) || texelFetch(material_image, texel, 0).r != id)
        continue;
      float there = view_depth(texelFetch(depth_image, texel, 0).r);
      if (!(there > 0.0))
        continue;
      vec3 way = texelFetch(scattered_image, texel, 0).rgb - own; // about the own light, so that nothing cancels
      sum += way;
      squares += way * way;
      count += 1.0;
      if (y == 0 && x != 0)
        least_step.x = min(least_step.x, abs(there - depth));
      if (x == 0 && y != 0)
        least_step.y = min(least_step.y, abs(there - depth));
    }
  vec3 mean = sum / max(count, 1.0);
  vec2 rise = mix(least_step, vec2(0.0), equal(least_step, vec2(none)));
  return neighbourhood(own + mean, sqrt(max(squares / max(count, 1.0) - mean * mean, vec3(0.0))), length(rise));
}

// By pixel of the tile: its light now and before; 0 pixels where there was none before.
shared vec3 lights_now[64], lights_before[64];
shared float seen[64];

vec3 change_over_the_tile() {
  if (!(settings.follow > 0.0))
    return vec3(1.0);
  light_pairs pairs = no_pairs();
  for (uint i = 0u; i < 64u; ++i)
    if (seen[i] > 0.0)
      add_pixel(pairs, lights_now[i], lights_before[i]);
  return brightness_change(pairs, settings.follow);
}

// What is kept where the light of a whole tile went out: what was there, for when it comes back.
struct two_lights {
  accumulated_light shown, kept;
};
two_lights with_history(accumulated_light history, vec3 light, neighbourhood around, vec3 change) {
  accumulated_light now = accumulated_light(light, 0.0);
  if (history.count > 0.0 && all(lessThan(change * change_most, vec3(1.0))))
    return two_lights(now, history);
  if (any(greaterThan(change, vec3(change_most))))
    history.count = 0.0;
  history.light *= change;
  if (history.count > 0.0 && settings.clip > 0.0)
    history = clip_to_neighbours(history, around.mean, around.deviation, settings.clip);
  now = add_frame(history, light, settings.weight);
  return two_lights(now, now);
}

void main() {
  ivec2 pixel;
  bool copy_only;
  bool listed = listed_pixel(pixel, copy_only);
  ivec2 texel = texel_of(pixel);
  uint id = 0u;
  float depth = 0.0;
  vec3 light = vec3(0.0);
  neighbourhood around;
  accumulated_light history = accumulated_light(vec3(0.0), 0.0);
  bool scatters = false;
  if (listed) {
    id = texelFetch(material_image, texel, 0).r;
    depth = view_depth(texelFetch(depth_image, texel, 0).r);
    light = texelFetch(scattered_image, texel, 0).rgb;
    scatters = id != 0u && !copy_only && depth > 0.0;
  }
  if (scatters) {
    around = look_around(pixel, id, depth);
    history = history_of(pixel, depth, id, around.rise);
  }
  lights_now[gl_LocalInvocationIndex] = light;
  lights_before[gl_LocalInvocationIndex] = history.light;
  seen[gl_LocalInvocationIndex] = history.count;
  barrier();
  if (!listed)
    return;
  two_lights now = two_lights(accumulated_light(light, 0.0), accumulated_light(light, 0.0));
  if (scatters)
    now = with_history(history, light, around, change_over_the_tile());
  imageStore(accumulated_image, texel, vec4(round_to_half(now.shown.light), 1.0));
  imageStore(past_out_image, texel, round_to_half(vec4(now.kept.light, now.kept.count)));
  imageStore(place_out_image, texel, round_to_half(vec4(depth / mm_per_metre, scatters ? float(id) : 0.0, 0.0, 0.0)));
}
