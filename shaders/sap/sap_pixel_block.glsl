// A block of the view's pixels, each read once; patches ignore pixels beyond the block. For kernels
// that store no level 0. Include after `pixels_across` and `pixels_down`.
#ifndef DERMIS_SAP_PIXEL_BLOCK_GLSL
#define DERMIS_SAP_PIXEL_BLOCK_GLSL

#include "sap/sap_pixel.glsl"

const int block_pixels = pixels_across * pixels_down;
uint pixel_profile[block_pixels];
float pixel_depth[block_pixels]; // mm; 0 if nothing is visible

float depth_of_profile(int x, int y, uint id) {
  bool inside = x >= 0 && y >= 0 && x < pixels_across && y < pixels_down;
  int index = inside ? y * pixels_across + x : 0;
  return inside && pixel_profile[index] == id ? pixel_depth[index] : 0.0;
}

// Returns the surface of pixel i of the block, whose depth must be above 0, as sap_pixel_surface.
sap_texel block_surface(ivec2 pixel, int i, out float area_root) {
  int x = i % pixels_across, y = i / pixels_across;
  uint id = pixel_profile[i];
  patch_neighbours around = patch_neighbours(vec2(depth_of_profile(x - 1, y, id), depth_of_profile(x, y - 1, id)),
                                             vec2(depth_of_profile(x + 1, y, id), depth_of_profile(x, y + 1, id)));
  return sap_pixel_surface(pixel, id, pixel_depth[i], around, area_root);
}

#endif
