#version 460
// Scattered light over frames, for hosts without anti-aliasing of their own: what a surface showed before is found again,
// drawn towards what is around it now, and mixed with this frame's.
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

uvec4 past_at(ivec2 pixel) { return texelFetch(past_image, previous_texel(pixel), 0); }

// Light and number of frames in halves, depth in mm, profile.
uvec4 pack_past(accumulated_light t, float depth, uint id) {
  return uvec4(packHalf2x16(t.light.rg), packHalf2x16(vec2(t.light.b, t.count)), floatBitsToUint(depth), id);
}
accumulated_light unpack_past(uvec4 bits) {
  vec2 pair = unpackHalf2x16(bits.y);
  return accumulated_light(vec3(unpackHalf2x16(bits.x), pair.x), pair.y);
}

bool written_before(ivec2 pixel) {
  ivec2 tile = pixel >> 3;
  int columns = (frame.previous_rect.z + 7) >> 3;
  return classes_before_data[tile.y * columns + tile.x] != class_none;
}

vec2 surface_before(ivec2 pixel) {
  if (!written_before(pixel))
    return vec2(0.0);
  uvec4 bits = past_at(pixel);
  return vec2(uintBitsToFloat(bits.z), float(bits.w));
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
      accumulated_light one = unpack_past(past_at(pixel));
      found.light += weight * one.light;
      found.count += weight * one.count;
    }
  found = accumulated_light(max(found.light, vec3(0.0)), max(found.count, 0.0));
  return true;
}

// count 0 where the surface was not to be seen.
accumulated_light history_of(ivec2 pixel, float depth, uint id, float rise) {
  accumulated_light found = accumulated_light(vec3(0.0), 0.0);
  if (!history_usable())
    return found;
  previous_place place = has_velocity()
                             ? place_before(vec2(pixel), depth, texelFetch(velocity_image, texel_of(pixel), 0).rgb)
                             : place_before(vec2(pixel), depth);
  float tolerance = depth_tolerance(place.depth, rise);
  history_taps taps = find_history(place, id, tolerance);
  if (taps.weight == vec4(0.0) || sharp_history(place, id, tolerance, found))
    return found;
  found = accumulated_light(vec3(0.0), 0.0);
  for (int i = 0; i < 4; ++i)
    if (taps.weight[i] > 0.0) {
      accumulated_light one = unpack_past(past_at(taps.first + ivec2(i & 1, i >> 1)));
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

void main() {
  ivec2 pixel;
  bool copy_only;
  if (!listed_pixel(pixel, copy_only))
    return;
  ivec2 texel = texel_of(pixel);
  uint id = texelFetch(material_image, texel, 0).r;
  float depth = view_depth(texelFetch(depth_image, texel, 0).r);
  accumulated_light now = accumulated_light(texelFetch(scattered_image, texel, 0).rgb, 0.0);
  bool scatters = id != 0u && !copy_only && depth > 0.0;
  if (scatters) {
    neighbourhood around = look_around(pixel, id, depth);
    accumulated_light history = history_of(pixel, depth, id, around.rise);
    if (history.count > 0.0 && settings.clip > 0.0)
      history = clip_to_neighbours(history, around.mean, around.deviation, settings.clip);
    now = add_frame(history, now.light, settings.weight);
  }
  now = accumulated_light(round_to_half(now.light), round_to_half(now.count));
  imageStore(accumulated_image, texel, vec4(now.light, 1.0));
  imageStore(past_out_image, texel, pack_past(now, depth, scatters ? id : 0u));
}
