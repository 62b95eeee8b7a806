#version 460
// The last step up without a stored level 0: a pixel's own light at full resolution, and all light
// of other pixels from level 1. Patches ignore pixels beyond blocks of 4x2 pixels.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "sap/subsurface_sap_gather_half.bindings.glsl"
#include "common/pixel_light.glsl"
#include "sap/sap_neighbours.glsl"
#include "sap/sap_pixel_block.glsl"

layout(local_size_x = 64, local_size_y = 1, local_size_z = 1) in;

bool stores_full() { return settings.storage == STORAGE_FULL; }
uvec2 level_tiles_at(uint index) { return level_tiles_data[index]; }

uvec4 read_coarse_surface(ivec2 address, int layer) {
  return texelFetch(coarse_surface_image, address, 0);
}
uvec4 read_coarse_scattered(ivec2 address, int layer) {
  return texelFetch(coarse_scattered_image, address, 0);
}
bool has_second_corner(uvec4 bits) { return false; }

// Texel shape: the texels under the group's tile, and the pixels of the tile.
shared uvec4 tile_coarse_surface[texel_shape ? coarse_under_pixels : 1];
shared uvec4 tile_coarse_scattered[texel_shape ? coarse_under_pixels : 1];
shared uint tile_profile[texel_shape ? 64 : 1];
shared float tile_depth[texel_shape ? 64 : 1];
// Block shape: those of a block.
const int block_coarse = square_pixels ? 4 * 3 : 5 * 3;
uvec4 coarse_surface[block_coarse], coarse_scattered[block_coarse];
uint block_profile[8];
float block_depth[8];

void keep_coarse(int i, uvec4 surface, uvec4 scattered) {
  if (texel_shape) {
    tile_coarse_surface[i] = surface;
    tile_coarse_scattered[i] = scattered;
  } else {
    coarse_surface[i] = surface;
    coarse_scattered[i] = scattered;
  }
}
uvec4 corner_surface(sap_place place, int n, int layer) {
  int i = corner_place(pixel_blocks, place, n);
  return texel_shape ? tile_coarse_surface[i] : coarse_surface[i];
}
uvec4 corner_scattered(sap_place place, int level, int n, int layer) {
  int i = corner_place(pixel_blocks, place, n);
  return texel_shape ? tile_coarse_scattered[i] : coarse_scattered[i];
}

pixel_rows read_rows() { return pixel_rows(texel_shape ? 8 : 4, pixel_blocks.size); }
uint profile_at(int i) { return texel_shape ? tile_profile[i] : block_profile[i]; }
float depth_at(int i) { return texel_shape ? tile_depth[i] : block_depth[i]; }

void read_pixel(int i, ivec2 pixel, bool copy_only) {
  ivec2 texel = texel_of(pixel);
  uint id = inside_rect(pixel) ? profile_of(texelFetch(material_image, texel, 0).r) : 0u;
  float depth = 0.0;
  if (id != 0u && !copy_only)
    depth = view_depth(texelFetch(depth_image, texel, 0).r);
  if (texel_shape) {
    tile_profile[i] = id;
    tile_depth[i] = depth;
  } else {
    block_profile[i] = id;
    block_depth[i] = depth;
  }
}

vec4 gather(sap_place place, ivec2 in_block, vec3 light) {
  uint id = profile_at(pixel_index(read_rows(), in_block));
  float area_root;
  sap_texel own = surface_at(scatter_scale_image, has_scatter_scale(), read_rows(), place.at,
                             in_block, area_root);
  // a tilted pixel keeps more of its own light
  vec3 across_px = sap_d_px(own), d_px = across_px * inversesqrt(area_root);
  vec3 centre = sap_lookup(id, sap_half, 0, d_px);
  float confidence;
  sap_sum rest = sap_from_coarser(place, 0, own, light, 1, confidence);
  rest.mass *= max(1.0 - centre, vec3(0.0));
  confidence = mix(confidence, 1.0, centre[profiles[min(id, 255u)].widest]);
  // Light that never scatters needs no surface around.
  vec3 direct = profile_direct(id);
  vec3 mean = sap_blend(max(centre - direct, vec3(0.0)), light, vec3(0.0), light, rest).light;
  return vec4(sap_keep_unscattered(across_px, light, mix(mean, light, direct)), confidence);
}

void main() {
  texel_block block;
  if (!listed_block(pixel_blocks, 0, gl_LocalInvocationIndex, block))
    return;
  [[unroll]] for (int k = 0; k < block_texels(pixel_blocks); ++k)
    read_pixel(texel_shape ? int(gl_LocalInvocationIndex) : k,
               block.first + block_offset(pixel_blocks, k), block.copy_only);
  if (!block.copy_only)
    read_coarser(block, pixel_blocks, 0, 1);
  finish_reading();
  [[unroll]] for (int k = 0; k < block_texels(pixel_blocks); ++k) {
    sap_place place = place_of(block, pixel_blocks, k, 0);
    if (!inside_rect(place.at))
      continue;
    ivec2 in_block = texel_shape ? block.first - 8 * block.tile : block_offset(pixel_blocks, k);
    vec4 result = vec4(0.0, 0.0, 0.0, 1.0);
    int i = pixel_index(read_rows(), in_block);
    if (profile_at(i) != 0u) {
      result.rgb = pixel_light(lighting_image, albedo_image, has_albedo(), settings.texturing,
                               texel_of(place.at));
      if (depth_at(i) > 0.0)
        result = gather(place, in_block, result.rgb);
    }
    imageStore(scattered_image, texel_of(place.at),
               stores_full() ? result : round_to_half(result));
  }
}
