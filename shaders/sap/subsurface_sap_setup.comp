#version 460
// Computes level 0 of the surface-aware pyramid: every pixel of listed tiles, 0 without subsurface.
// Patches need material and depth of a ring around the block or tile. Marks the pixels next to
// another surface.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "sap/subsurface_sap_setup.bindings.glsl"
#include "common/pixel_light.glsl"
#include "sap/sap_blocks.glsl"
#include "sap/sap_pixel.glsl"
#include "sap/sap_storage.glsl"

layout(local_size_x = 64, local_size_y = 1, local_size_z = 1) in;

bool stores_full() { return settings.storage == STORAGE_FULL; }
uvec2 level_tiles_at(uint index) { return level_tiles_data[index]; }

const int ring_width = (texel_shape ? 8 : 4) + 2, ring_height = (texel_shape ? 8 : 2) + 2;
const int block_pixels = 6 * 4; // with the ring
// mm; 0 if nothing is visible
uint block_profile[block_pixels];
float block_depth[block_pixels];
shared uint tile_profile[texel_shape ? 100 : 1];
shared float tile_depth[texel_shape ? 100 : 1];

uint profile_at(int i) { return texel_shape ? tile_profile[i] : block_profile[i]; }
float depth_at(int i) { return texel_shape ? tile_depth[i] : block_depth[i]; }
float depth_of_profile(int i, uint id) { return profile_at(i) == id ? depth_at(i) : 0.0; }

// Reads element i of the ring around the pixels from `first` on.
void read_pixel(ivec2 first, int i) {
  int x = i % ring_width, y = i / ring_width;
  bool corner = (x == 0 || x == ring_width - 1) && (y == 0 || y == ring_height - 1);
  ivec2 pixel = first + ivec2(x, y) - 1, texel = texel_of(pixel);
  uint id = 0u;
  float depth = 0.0;
  if (!corner && inside_rect(pixel))
    id = profile_of(texelFetch(material_image, texel, 0).r);
  if (id != 0u)
    depth = view_depth(texelFetch(depth_image, texel, 0).r);
  if (texel_shape) {
    tile_profile[i] = id;
    tile_depth[i] = depth;
  } else {
    block_profile[i] = id;
    block_depth[i] = depth;
  }
}
void read_ring(texel_block block) {
  if (texel_shape) {
    [[dont_unroll]] for (int i = int(gl_LocalInvocationIndex); i < ring_width * ring_height;
                         i += 64) read_pixel(8 * block.tile, i);
    barrier();
  } else {
    [[unroll]] for (int i = 0; i < block_pixels; ++i)
      read_pixel(block.first, i);
  }
}

// Change of depth per pixel, in sides of a pixel, beyond which a pixel is next to another surface.
const float edge_slope = 3.0;

// Returns whether the pixel at `here` is next to another surface: one of another profile, or one
// that is far off in depth.
bool is_at_edge(int here) {
  uint id = profile_at(here);
  float depth = depth_at(here);
  vec2 max_step = edge_slope * pixel_footprint(depth);
  bool found = false;
  [[unroll]] for (int i = 0; i < 4; ++i) {
    bool along_row = i < 2;
    int near = here + ((i & 1) == 0 ? -1 : 1) * (along_row ? 1 : ring_width);
    bool apart = profile_at(near) != id ||
                 abs(depth_at(near) - depth) > (along_row ? max_step.x : max_step.y);
    found = found || depth_at(near) > 0.0 && apart;
  }
  return found;
}

void main() {
  texel_block block;
  if (!listed_block(pixel_blocks, 0, gl_LocalInvocationIndex, block))
    return;
  read_ring(block);
  [[unroll]] for (int k = 0; k < block_texels(pixel_blocks); ++k) {
    ivec2 pixel = block.first + block_offset(pixel_blocks, k), texel = texel_of(pixel);
    if (!inside_rect(pixel))
      continue;
    ivec2 place = texel_shape ? pixel - 8 * block.tile + 1 : block_offset(pixel_blocks, k) + 1;
    int here = place.y * ring_width + place.x;
    uint id = profile_at(here);
    float depth = depth_at(here);
    vec4 light = vec4(0.0);
    uvec4 bits = uvec4(0u);
    bool at_edge = false;
    if (id != 0u) {
      sap_texel own = sap_flat;
      light.rgb =
          pixel_light(lighting_image, albedo_image, has_albedo(), settings.texturing, texel);
      if (depth > 0.0) {
        patch_neighbours around = patch_neighbours(
            vec2(depth_of_profile(here - 1, id), depth_of_profile(here - ring_width, id)),
            vec2(depth_of_profile(here + 1, id), depth_of_profile(here + ring_width, id)));
        own = sap_pixel_surface(scatter_scale_image, has_scatter_scale(), pixel, id, depth, around,
                                light.a);
        at_edge = is_at_edge(here);
      }
      light = sap_stored(light);
      bits = sap_pack(own, sap_pack_light(light, stores_full()));
      bits = sap_with_held(bits, own.id != 0u ? sap_max_held : 0u, 0u);
      bits.x |= at_edge ? sap_second_bit : 0u;
    }
    imageStore(light_image, texel, light);
    imageStore(surface_image, texel, bits);
  }
}
