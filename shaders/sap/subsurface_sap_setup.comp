#version 460
// Computes level 0 of the surface-aware pyramid: every pixel of listed tiles, 0 if nothing
// scatters. An invocation computes a block of pixels, whose patches need material and depth of a
// ring around the block.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "sap/subsurface_sap_setup.bindings.glsl"
#include "common/environment.glsl"
#include "sap/sap_pixel.glsl"
const int block_width = 4, block_height = 2;
#include "sap/sap_tiles.glsl"

const int ring_width = block_width + 2, ring_height = block_height + 2;
uint ring_profile[ring_width * ring_height];
float ring_depth[ring_width * ring_height]; // mm; 0 if nothing is visible

void read_ring(ivec2 first) {
  [[unroll]] for (int i = 0; i < ring_width * ring_height; ++i) {
    int x = i % ring_width, y = i / ring_width;
    bool corner = (x == 0 || x == ring_width - 1) && (y == 0 || y == ring_height - 1);
    ivec2 pixel = first + ivec2(x, y) - 1, texel = texel_of(pixel);
    uint id = 0u;
    float depth = 0.0;
    if (!corner && inside_rect(pixel))
      id = texelFetch(material_image, texel, 0).r;
    if (id != 0u)
      depth = view_depth(texelFetch(depth_image, texel, 0).r);
    ring_profile[i] = id;
    ring_depth[i] = depth;
  }
}
float depth_of_profile(int index, uint id) { return ring_profile[index] == id ? ring_depth[index] : 0.0; }

void main() {
  texel_block block;
  if (!listed_block(0, block))
    return;
  read_ring(block.first);
  [[unroll]] for (int k = 0; k < block_width * block_height; ++k) {
    ivec2 pixel = block.first + ivec2(k % block_width, k / block_width), texel = texel_of(pixel);
    if (!inside_rect(pixel))
      continue;
    int here = (k / block_width + 1) * ring_width + k % block_width + 1;
    uint id = ring_profile[here];
    float depth = ring_depth[here];
    vec4 light = vec4(0.0);
    uvec4 bits = uvec4(0u);
    if (id != 0u) {
      light.rgb =
          pixel_light(lighting_image, albedo_image, has_albedo(), settings.texturing, texel);
      if (depth > 0.0) {
        patch_neighbours around = patch_neighbours(
            vec2(depth_of_profile(here - 1, id), depth_of_profile(here - ring_width, id)),
            vec2(depth_of_profile(here + 1, id), depth_of_profile(here + ring_width, id)));
        bits = sap_pack(sap_pixel_surface(pixel, id, depth, around, light.a));
      }
    }
    imageStore(light_image, texel, settings.storage == STORAGE_FULL ? light : round_to_half(light));
    imageStore(surface_image, texel, bits);
  }
}
