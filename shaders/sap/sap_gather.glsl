// The last step up: computes the scattered light and the confidence of a pixel, from the nearer
// layers of level 1. The kernel that includes this file also defines the functions of
// sap_neighbours.glsl that read images.
#ifndef DERMIS_SAP_GATHER_GLSL
#define DERMIS_SAP_GATHER_GLSL

#include "sap/sap_neighbours.glsl"

// Texel shape: the pixels of the group, and both layers of the texels under them.
shared uvec4 tile_surface[texel_shape ? ring_texels : 1];
shared uvec2 tile_light[texel_shape ? ring_texels : 1];
shared uvec4 tile_coarse_surface[texel_shape ? 2 * coarse_under_pixels : 1];
shared uvec4 tile_coarse_scattered[texel_shape ? 2 * coarse_under_pixels : 1];
// Block shape: the texels of a block and its ring, in registers.
const int block_ring = (4 + 2 * ring_reach) * (2 + 2 * ring_reach);
const int block_coarse = square_pixels ? 4 * 3 : 5 * 3;
uvec4 ring_surface[block_ring];
vec4 ring_light[block_ring];
uvec4 coarse_surface[2 * block_coarse], coarse_scattered[2 * block_coarse];

void keep_texel(int i, uvec4 surface, vec4 light) {
  if (texel_shape) {
    tile_surface[i] = surface;
    tile_light[i] = uvec2(packHalf2x16(light.rg), sap_light_ba(surface));
  } else {
    ring_surface[i] = surface;
    ring_light[i] = sap_stored_light(surface, light);
  }
}
void keep_coarse(int i, uvec4 surface, uvec4 scattered) {
  if (texel_shape) {
    tile_coarse_surface[i] = surface;
    tile_coarse_scattered[i] = scattered;
  } else {
    coarse_surface[i] = surface;
    coarse_scattered[i] = scattered;
  }
}
uvec4 kept_surface(int i) { return tile_surface[i]; }
uvec2 kept_light(int i) { return tile_light[i]; }

uvec4 near_surface(sap_place place, ivec2 step, int layer) {
  int i = ring_place(pixel_blocks, place, step);
  return texel_shape ? tile_surface[i] : ring_surface[i];
}
vec4 near_light(sap_place place, int level, ivec2 step, int layer) {
  return texel_shape ? light_in_tile(pixel_blocks, place, level, step, layer)
                     : ring_light[ring_place(pixel_blocks, place, step)];
}
uvec4 corner_surface(sap_place place, int n, int layer) {
  int i = layer * coarse_texels(pixel_blocks) + corner_place(pixel_blocks, place, n);
  return texel_shape ? tile_coarse_surface[i] : coarse_surface[i];
}
uvec4 corner_scattered(sap_place place, int level, int n, int layer) {
  int i = layer * coarse_texels(pixel_blocks) + corner_place(pixel_blocks, place, n);
  return texel_shape ? tile_coarse_scattered[i] : coarse_scattered[i];
}

const float min_fraction = 0.002; // the tent is not worth its time for a smaller weight

// Returns the light of the pixel at `place`, whose own light is `centre_light`.
vec4 gather(sap_place place, sap_texel own, vec4 centre_light, int variant) {
  vec3 light = centre_light.rgb;
  // a tilted pixel keeps more of its own light
  vec3 across_px = sap_d_px(own), d_px = across_px * inversesqrt(centre_light.a);
  vec3 centre, tent;
  sap_weights_of_level_0(own.id, variant, d_px, centre, tent);
  sap_sum near = sap_sum(light, vec3(1.0));
  if (max(tent.r, max(tent.g, tent.b)) >= min_fraction)
    near = sap_tent(place, 0, own, 1);
  float confidence;
  sap_sum rest = sap_from_coarser(place, 0, own, light, 2, confidence);
  rest.mass *= max(1.0 - centre - tent, vec3(0.0));
  uint widest = profiles[min(own.id, 255u)].widest;
  confidence = mix(confidence, 1.0, centre[widest] + tent[widest]); // level 0 misses nothing
  // Light that never scatters needs no surface around.
  vec3 direct = profile_direct(own.id);
  vec3 mean = sap_blend(max(centre - direct, vec3(0.0)), light, tent * near.mass,
                        near.light, rest)
                  .light;
  return vec4(sap_keep_unscattered(across_px, light, mix(mean, light, direct)), confidence);
}

#endif
