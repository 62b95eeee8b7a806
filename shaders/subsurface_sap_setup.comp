#version 460
// Level 0 of the surface-aware pyramid: every pixel of listed tiles, 0 where nothing scatters.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "subsurface_sap_setup.bindings.glsl"
#include "environment.glsl"
#include "tiles.glsl"
#include "half.glsl"
#include "sanitise.glsl"
#include "radius.glsl"
#include "patch.glsl"
#include "sap.glsl"

void main() {
  ivec2 pixel;
  bool copy_only;
  bool listed = listed_pixel(pixel, copy_only);
  share_patches(pixel - ivec2(gl_LocalInvocationID.xy));
  if (!listed)
    return;
  ivec2 texel = texel_of(pixel);
  uint id = own_profile();
  vec4 light = vec4(0.0);
  uvec4 bits = uvec4(0u);
  if (id != 0u) {
    light.rgb = clean_light(texelFetch(lighting_image, texel, 0).rgb);
    if (settings.texturing != TEXTURING_POST && has_albedo()) {
      vec3 albedo = clean_albedo(texelFetch(albedo_image, texel, 0).rgb);
      light.rgb *= settings.texturing == TEXTURING_PRE ? albedo : sqrt(albedo);
    }
    float depth = own_depth();
    if (depth > 0.0) {
      surface_patch patch_here = build_patch(pixel);
      vec2 sides = pixel_footprint(depth);
      float scale = has_scatter_scale() ? clean_scatter_scale(texelFetch(scatter_scale_image, texel, 0).r) : 1.0;
      float reach = min(sqrt(sqrt(1.0 / patch_here.area)) * scale, largest_half);
      light.a = min(patch_here.area, sap_area_cap);
      bits = sap_pack(sap_texel(depth, round_to_half(vec3(patch_here.slope * sides / sap_footprint(depth), 0.0)).xy,
                                round_to_half(reach), 1.0, id));
    }
  }
  imageStore(light_image, texel, round_to_half(light));
  imageStore(surface_image, texel, bits);
}
