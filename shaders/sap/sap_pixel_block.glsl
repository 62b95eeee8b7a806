// Pixels of the view, each read once; patches ignore pixels beyond a block of `pixels_across` x
// `pixels_down`. For kernels that store no level 0. In the block shape an invocation has one block.
// In the texel shape the `tile_pixels` x `tile_pixels` pixels of a tile are in shared memory.
// Include after these three constants and sap_tiles.glsl.
#ifndef DERMIS_SAP_PIXEL_BLOCK_GLSL
#define DERMIS_SAP_PIXEL_BLOCK_GLSL

#include "sap/sap_pixel.glsl"

const int block_pixels = pixels_across * pixels_down;
const int pixel_row = texel_shape ? tile_pixels : pixels_across;
// mm; 0 if nothing is visible
uint block_profile[block_pixels];
float block_depth[block_pixels];
shared uint tile_profile[texel_shape ? tile_pixels * tile_pixels : 1];
shared float tile_depth[texel_shape ? tile_pixels * tile_pixels : 1];

int pixel_index(ivec2 place) { return place.y * pixel_row + place.x; }
uint profile_at(int i) { return texel_shape ? tile_profile[i] : block_profile[i]; }
float depth_at(int i) { return texel_shape ? tile_depth[i] : block_depth[i]; }

void keep_pixel(int i, ivec2 pixel, bool with_profile, bool with_depth) {
  uint id = with_profile ? texelFetch(material_image, texel_of(pixel), 0).r : 0u;
  float depth =
      id != 0u && with_depth ? view_depth(texelFetch(depth_image, texel_of(pixel), 0).r) : 0.0;
  if (texel_shape) {
    tile_profile[i] = id;
    tile_depth[i] = depth;
  } else {
    block_profile[i] = id;
    block_depth[i] = depth;
  }
}

// Returns the depth of the pixel next to `place`; 0 in another block or with another profile.
float depth_next_to(ivec2 place, ivec2 offset, uint id) {
  ivec2 next = place + offset, block = ivec2(pixels_across, pixels_down);
  bool inside = all(greaterThanEqual(next, ivec2(0))) && next / block == place / block;
  int i = inside ? pixel_index(next) : 0;
  return inside && profile_at(i) == id ? depth_at(i) : 0.0;
}

// Returns the surface of the pixel at `place`, whose depth must be above 0, as sap_pixel_surface.
sap_texel surface_at(ivec2 pixel, ivec2 place, out float area_root) {
  int i = pixel_index(place);
  uint id = profile_at(i);
  patch_neighbours around = patch_neighbours(
      vec2(depth_next_to(place, ivec2(-1, 0), id), depth_next_to(place, ivec2(0, -1), id)),
      vec2(depth_next_to(place, ivec2(1, 0), id), depth_next_to(place, ivec2(0, 1), id)));
  return sap_pixel_surface(pixel, id, depth_at(i), around, area_root);
}

#endif
