#version 460
// How much brighter all that is seen has become since history began, as a logarithm: what most surfaces became between the
// frame before and this one, added up. Each is compared with itself, wherever the camera went. One group; a pixel of each
// tile, or of some.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "subsurface_brightness.bindings.glsl"
#include "environment.glsl"
#include "tile_packing.glsl"
#include "sap.glsl"
vec2 surface_before(ivec2 pixel);
#include "reproject.glsl"
#include "residual.glsl"

layout(local_size_x = 64, local_size_y = 1, local_size_z = 1) in;

const uint lanes = 64u;
const uint each = 16u;    // pixels that a lane looks at, at most
const float width = 0.25; // of a logarithm: what changed more than most by as much counts half
const int turns = 8;      // towards what most did

shared float changes[lanes * each]; // logarithms
shared bool known[lanes * each];
shared vec2 sums[lanes];

vec2 surface_before(ivec2 pixel) { return residual_surface_before(texelFetch(place_image, previous_texel(pixel), 0)); }

// Of the surface at a pixel; false where it was not to be seen before, or is dark.
bool change_of(ivec2 pixel, out float change) {
  change = 0.0;
  if (!inside_rect(pixel) || class_of_tile(classes_data[sap_tile(pixel)]) != class_scatter)
    return false;
  ivec2 texel = texel_of(pixel);
  sap_texel own = sap_unpack(texelFetch(surface_image, texel, 0));
  vec3 light = texelFetch(scattered_image, texel, 0).rgb;
  if (own.id == 0u || !is_lit(light))
    return false;
  previous_place place = has_velocity()
                             ? place_before(vec2(pixel), own.depth, texelFetch(velocity_image, texel, 0).rgb)
                             : place_before(vec2(pixel), own.depth);
  history_taps taps =
      find_history(place, own.id, depth_tolerance(place.depth, length(own.slope) * sap_footprint(own.depth)));
  float before = 0.0;
  for (int i = 0; i < 4; ++i)
    if (taps.weight[i] > 0.0)
      before += taps.weight[i] * texelFetch(place_image, previous_texel(taps.first + ivec2(i & 1, i >> 1)), 0).a;
  change = brightness(light) - before;
  return taps.weight != vec4(0.0) && before > never_lit;
}

// Sum over the group.
vec2 summed(vec2 own) {
  barrier();
  sums[gl_LocalInvocationIndex] = own;
  barrier();
  vec2 sum = vec2(0.0);
  for (uint i = 0u; i < lanes; ++i)
    sum += sums[i];
  return sum;
}

void main() {
  uint lane = gl_LocalInvocationIndex, tiles = uint(frame.tiles.x * frame.tiles.y);
  uint stride = max((tiles + lanes * each - 1u) / (lanes * each), 1u);
  for (uint k = 0u; k < each; ++k) {
    uint tile = (k * lanes + lane) * stride;
    ivec2 pixel = ivec2(tile % uint(frame.tiles.x), tile / uint(frame.tiles.x)) * 8 + 3;
    float change = 0.0;
    known[k * lanes + lane] = history_usable() && tile < tiles && change_of(pixel, change);
    changes[k * lanes + lane] = change;
  }
  // What most did: the mean, then again and again with weights that fall with the distance from it.
  float found = 0.0;
  for (int turn = 0; turn < turns; ++turn) {
    vec2 sum = vec2(0.0);
    for (uint k = 0u; k < each; ++k) {
      uint i = k * lanes + lane;
      float off = (changes[i] - found) / width;
      float weight = turn == 0 ? 1.0 : 1.0 / (1.0 + off * off);
      if (known[i])
        sum += weight * vec2(changes[i], 1.0);
    }
    sum = summed(sum);
    found = sum.y > 0.0 ? sum.x / sum.y : 0.0;
  }
  float before = history_usable() ? texelFetch(brightness_image, ivec2(0), 0).r : 0.0;
  if (lane == 0u)
    imageStore(brightness_out_image, ivec2(0), vec4(before + found, 0.0, 0.0, 0.0));
}
