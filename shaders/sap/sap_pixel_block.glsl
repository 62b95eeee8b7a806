// Surfaces of pixels of the view, each read once, for kernels that store no level 0. Patches ignore
// pixels beyond a block.
#ifndef DERMIS_SAP_PIXEL_BLOCK_GLSL
#define DERMIS_SAP_PIXEL_BLOCK_GLSL

#include "sap/sap_pixel.glsl"

// The kernel that includes this file defines both functions: the profile and the depth (mm; 0 if
// nothing is visible) of pixel i of those that the kernel has read, row by row.
uint profile_at(int i);
float depth_at(int i);

struct pixel_rows {
  int pixels;  // of a row of those that the kernel has read
  ivec2 block; // size of a block, powers of two
};
int pixel_index(pixel_rows rows, ivec2 place) { return place.y * rows.pixels + place.x; }

// Returns the depth of the pixel next to `place`; 0 in another block or with another profile.
float depth_next_to(pixel_rows rows, ivec2 place, ivec2 offset, uint id) {
  ivec2 next = place + offset;
  bool inside = ((next ^ place) & -rows.block) == ivec2(0);
  int i = inside ? pixel_index(rows, next) : 0;
  bool same = profile_at(i) == id;
  float depth = depth_at(i);
  return inside && same ? depth : 0.0;
}

// Returns the surface of the pixel at `place`, whose depth must be above 0, as sap_pixel_surface.
sap_texel surface_at(texture2D scatter_scale, bool scale_bound, pixel_rows rows, ivec2 pixel,
                     ivec2 place, out float area_root) {
  int i = pixel_index(rows, place);
  uint id = profile_at(i);
  patch_neighbours around = patch_neighbours(vec2(depth_next_to(rows, place, ivec2(-1, 0), id),
                                                  depth_next_to(rows, place, ivec2(0, -1), id)),
                                             vec2(depth_next_to(rows, place, ivec2(1, 0), id),
                                                  depth_next_to(rows, place, ivec2(0, 1), id)));
  return sap_pixel_surface(scatter_scale, scale_bound, pixel, id, depth_at(i), around, area_root);
}

#endif
