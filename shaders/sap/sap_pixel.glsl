// A pixel of the view as a texel of level 0 of the surface-aware pyramid.
#ifndef DERMIS_SAP_PIXEL_GLSL
#define DERMIS_SAP_PIXEL_GLSL

#extension GL_EXT_samplerless_texture_functions : require

#include "common/half.glsl"
#include "common/patch.glsl"
#include "common/radius.glsl"
#include "sap/sap.glsl"

// Returns the surface of a pixel at a depth above 0, and the fourth root of its area divided by its
// cross-section. `scatter_scale` is not read unless `scale_bound`.
sap_texel sap_pixel_surface(texture2D scatter_scale, bool scale_bound, ivec2 pixel, uint id,
                            float depth, patch_neighbours around, out float area_root) {
  surface_patch patch_here = build_patch(pixel, depth, around);
  vec2 sides = pixel_footprint(depth);
  float scale =
      scale_bound ? clean_scatter_scale(texelFetch(scatter_scale, texel_of(pixel), 0).r) : 1.0;
  area_root = sqrt(sqrt(patch_here.area));
  float reach = min(inversesqrt(area_root) * scale, sap_max_reach);
  return sap_texel(depth,
                   round_to_half(vec3(patch_here.slope * sides / sap_footprint(depth), 0.0)).xy,
                   round_to_half(reach), 1.0, id);
}

#endif
