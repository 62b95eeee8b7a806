#version 460
// Blends samples into the pyramid's light in place, in tiles that have samples; lower confidence
// gives more weight to the samples. Towards tiles without samples, the weight of the samples falls
// to 0, so that no seams appear.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "sap/subsurface_tile_refine.bindings.glsl"
#include "common/environment.glsl"
#include "common/tiles.glsl"
#include "common/half.glsl"
#include "sap/sap_samples.glsl"
#include "sap/sample_allocation.glsl"
#include "common/tile_edges.glsl"

bool near_written(ivec2 at) { return class_of_tile(classes_data[sap_tile(at)]) != class_none; }
uvec4 level_surface(int level, ivec2 address) {
  return fetch_level(surface_1_image, surface_2_image, surface_3_image, surface_4_image,
                     surface_5_image, level, address);
}
vec4 level_light(int level, ivec2 address) {
  return fetch_level(light_1_image, light_2_image, light_3_image, light_4_image, light_5_image,
                     level, address);
}

const float ramp_px = 4.0; // half a tile

void main() {
  ivec2 pixel;
  bool copy_only;
  uint listed = listed_tile();
  if (listed >= tiles_data[0] || !pixel_of_tile(tiles_data[1u + listed], pixel, copy_only))
    return;
  ivec2 texel = texel_of(pixel);
  vec4 light = imageLoad(scattered_image, texel);
  sap_texel own = sap_unpack(texelFetch(surface_image, texel, 0));
  if (own.id == 0u || light.a >= settings.below)
    return;
  ivec2 tile = pixel >> 3;
  int count = samples_of(samples_per_tile_data[tile.y * frame.tiles.x + tile.x]);
  uint sampled_tiles = 0u;
  for (int i = 0; i < edge_tiles; ++i) {
    int at = edge_tile(tile, i);
    sampled_tiles |= has_samples(classes_data[at], samples_per_tile_data[at]) ? 1u << uint(i) : 0u;
  }
  float fraction = edge_weight(sampled_tiles, pixel, ramp_px) *
                   sample_fraction(light.a, float(count), settings.sample_weight);
  uvec2 offset = r2_point(offset_from_hash(pcg3d16(uvec3(pixel, 0u)).xy), frame.frame_index);
  vec3 own_light = pixel_light_of_level_0(surface_image, light_image, texel);
  vec3 sampled = sap_sampled_light(surface_image, light_image, pixel, own, own_light, offset,
                                   count, settings.lod_bias);
  imageStore(scattered_image, texel,
             vec4(round_to_half(mix(light.rgb, sampled, fraction)), light.a));
}
