#version 460
// Samples where a tile was given some, blended into the pyramid's light in place: the less its confidence, the more. No
// seams: towards tiles that were given none the share of the samples falls to nothing.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "subsurface_mend.bindings.glsl"
#include "environment.glsl"
#include "tiles.glsl"
#include "half.glsl"
#include "sap.glsl"
bool near_written(ivec2 at) { return classes_data[sap_tile(at)] != class_none; }
#include "sap_samples.glsl"
#include "allotment.glsl"

const float ramp_px = 4.0; // half a tile
const float soft = 0.2;    // of confidence, below `below`: from no share to all of it

bool has_samples(ivec2 tile) {
  ivec2 at = clamp(tile, ivec2(0), frame.tiles - 1);
  uint index = uint(at.y * frame.tiles.x + at.x);
  return shares_data[index] > 0u || classes_data[index] != class_scatter; // nothing of the pyramid's borders there
}

float ramp(float px) { return smoothstep(0.0, 1.0, px / ramp_px); }

// 1 inside, 0 at an edge or a corner that a tile without samples shares.
float edge_weight(ivec2 pixel) {
  ivec2 tile = pixel >> 3;
  vec2 from = vec2(pixel & 7) + 0.5; // from the left and upper edge
  float weight = 1.0;
  for (int y = -1; y <= 1; ++y)
    for (int x = -1; x <= 1; ++x) {
      if ((x == 0 && y == 0) || has_samples(tile + ivec2(x, y)))
        continue;
      vec2 distance = vec2(x < 0 ? from.x : 8.0 - from.x, y < 0 ? from.y : 8.0 - from.y);
      weight = min(weight, ramp(x == 0 ? distance.y : y == 0 ? distance.x : max(distance.x, distance.y)));
    }
  return weight;
}

void main() {
  ivec2 pixel;
  bool copy_only;
  if (!listed_pixel(pixel, copy_only))
    return;
  ivec2 texel = texel_of(pixel);
  vec4 light = imageLoad(scattered_image, texel);
  sap_texel own = sap_unpack(texelFetch(surface_image, texel, 0));
  if (own.id == 0u || light.a >= settings.below)
    return;
  ivec2 tile = pixel >> 3;
  int count = samples_of(shares_data[tile.y * frame.tiles.x + tile.x]);
  float share = settings.share * edge_weight(pixel) * clamp((settings.below - light.a) / soft, 0.0, 1.0);
  uvec2 offset = r2_point(offset_from_hash(pcg3d16(uvec3(pixel, 0u)).xy), frame.frame_index);
  vec3 sampled = sap_sampled_light(pixel, own, texelFetch(light_image, texel, 0).rgb, offset, count, settings.lod_bias);
  imageStore(scattered_image, texel, vec4(round_to_half(mix(light.rgb, sampled, share)), light.a));
}
