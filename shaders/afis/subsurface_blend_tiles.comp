#version 460
// Replaces the light of another technique in tiles that have samples. Towards tiles without
// samples, the weight of the other technique rises to 1, so that no seams appear.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "afis/subsurface_blend_tiles.bindings.glsl"
#include "common/environment.glsl"
#include "common/half.glsl"
#include "common/tile_edges.glsl"
#include "common/tiles.glsl"

void main() {
  ivec2 pixel;
  bool copy_only;
  uint listed = listed_tile();
  if (listed >= tiles_data[0] || !pixel_of_tile(tiles_data[1u + listed], pixel, copy_only))
    return;
  ivec2 texel = texel_of(pixel), tile = pixel >> 3;
  if (texelFetch(material_image, texel, 0).r == 0u)
    return;
  uint sampled_tiles = 0u;
  for (int i = 0; i < edge_tiles; ++i) {
    int at = edge_tile(tile, i);
    sampled_tiles |= has_samples(classes_data[at], samples_per_tile_data[at]) ? 1u << uint(i) : 0u;
  }
  float fraction = edge_weight(sampled_tiles, pixel, replaced_ramp_px);
  vec3 light = texelFetch(sampled_image, texel, 0).rgb;
  // The other technique did not run where all tiles around have samples.
  if (fraction < 1.0)
    light = mix(imageLoad(scattered_image, texel).rgb, light, fraction);
  imageStore(scattered_image, texel, vec4(round_to_half(light), 1.0));
}
