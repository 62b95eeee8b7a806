#version 460
// Where the pyramid is unsure, its light is multiplied by the running ratio of samples to it. The ratio does not see how
// bright the light is, so it does not lag behind light that flickers. A pixel samples in one frame of four or of sixteen,
// by how unsure it is and by its tile, or in each, twice as many, while it has little history.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "subsurface_residual.bindings.glsl"
#include "environment.glsl"
#include "tiles.glsl"
#include "half.glsl"
#include "sap.glsl"
bool near_written(ivec2 at) { return classes_data[sap_tile(at)] != class_none; }
vec2 surface_before(ivec2 pixel);
#include "reproject.glsl"
#include "sap_samples.glsl"

const float mm_per_metre = 1000.0;
const float largest_kept = 8.0;  // of a sampled ratio
const float largest_ratio = 4.0; // that light is multiplied by
const float doubt = 16.0;        // samples that weigh as much as the pyramid
const float least_light = 1e-6;  // of the pyramid; a ratio to less says nothing
const float memory = 1.9;        // samples that a moving mean of weight alpha is worth, in n / alpha: (2 - alpha) / alpha

// Depth is kept in metres: half floats hold it within .05 % from a tenth of a millimetre to 65 km.
vec2 surface_before(ivec2 pixel) {
  vec2 kept = texelFetch(place_image, previous_texel(pixel), 0).rg;
  return vec2(kept.r * mm_per_metre, kept.g);
}

// rgb = ratio, a = samples behind it; a = -1 where the surface was not to be seen in the frame before.
vec4 ratio_before(ivec2 pixel, sap_texel own) {
  previous_place place = has_velocity()
                             ? place_before(vec2(pixel), own.depth, texelFetch(velocity_image, texel_of(pixel), 0).rgb)
                             : place_before(vec2(pixel), own.depth);
  float rise = length(own.slope) * sap_footprint(own.depth);
  history_taps taps = find_history(place, own.id, depth_tolerance(place.depth, rise));
  vec4 sum = vec4(0.0);
  for (int i = 0; i < 4; ++i)
    if (taps.weight[i] > 0.0)
      sum += taps.weight[i] * texelFetch(ratio_image, previous_texel(taps.first + ivec2(i & 1, i >> 1)), 0);
  return taps.weight == vec4(0.0) ? vec4(1.0, 1.0, 1.0, -1.0) : sum;
}

// Which of four or of sixteen frames it is the tile's turn: each 2x2 or 4x4 tiles take one each.
bool is_turn(ivec2 tile, float confidence) {
  if (confidence < settings.often_below)
    return (uint(tile.x & 1) + 2u * uint(tile.y & 1)) == (frame.frame_index & 3u);
  return (uint(tile.x & 3) + 4u * uint(tile.y & 3)) == (frame.frame_index & 15u);
}

void main() {
  ivec2 pixel;
  bool copy_only;
  if (!listed_pixel(pixel, copy_only))
    return;
  ivec2 texel = texel_of(pixel);
  vec4 light = texelFetch(scattered_image, texel, 0);
  sap_texel own = sap_unpack(texelFetch(surface_image, texel, 0));
  vec4 ratio = vec4(1.0, 1.0, 1.0, 0.0);
  int count = 0;
  bool lost = false;
  if (own.id != 0u && !copy_only) {
    if (history_usable()) {
      ratio = ratio_before(pixel, own);
      lost = ratio.a < 0.0;
      ratio.a = max(ratio.a, 0.0);
    }
    float n = float(settings.samples);
    if (light.a >= settings.below) {
      ratio.a *= 1.0 - 0.25 * settings.alpha; // nothing new is learned here
    } else if (is_turn(pixel >> 3, light.a) || ratio.a < float(settings.eager) * n) {
      count = ratio.a < float(settings.eager) * n ? 2 * settings.samples : settings.samples;
      // Frames in which it is a tile's turn follow each other in the sequence; the others stand far from them.
      uint index = (frame.frame_index >> 2) + (frame.frame_index & 3u) * 0x9e3779u;
      uvec2 offset = r2_point(offset_from_hash(pcg3d16(uvec3(pixel, 0u)).xy), index);
      vec3 sampled = sap_sampled_light(pixel, own, texelFetch(light_image, texel, 0).rgb, offset, count, settings.lod_bias);
      vec3 found = clamp(sampled / max(light.rgb, vec3(least_light)), vec3(0.0), vec3(largest_kept));
      found = mix(vec3(1.0), found, greaterThan(light.rgb, vec3(least_light)));
      ratio.rgb = mix(ratio.rgb, found, max(settings.alpha, float(count) / (ratio.a + float(count))));
      ratio.a = min(ratio.a + float(count), memory * n / settings.alpha);
    }
    light.rgb *= 1.0 + ratio.a / (ratio.a + doubt) * (min(ratio.rgb, vec3(largest_ratio)) - 1.0);
  }
  imageStore(mended_image, texel, round_to_half(light));
  imageStore(ratio_out_image, texel, round_to_half(ratio));
  imageStore(place_out_image, texel, round_to_half(vec4(own.depth / mm_per_metre, float(own.id), 0.0, 0.0)));
  if (has_sampling())
    imageStore(sampling_image, texel, vec4(float(count), ratio.a, light.a, lost ? 1.0 : 0.0));
}
