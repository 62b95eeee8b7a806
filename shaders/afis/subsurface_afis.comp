#version 460
// Filtered importance sampling with the same number of samples in all pixels.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "afis/subsurface_afis.bindings.glsl"
#include "common/environment.glsl"
#include "common/tiles.glsl"
#include "common/half.glsl"
#include "afis/afis.glsl"

void main() {
  ivec2 pixel;
  bool copy_only;
  if (!listed_pixel(pixel, copy_only))
    return;
  ivec2 texel = texel_of(pixel);
  uint id = texelFetch(material_image, texel, 0).r;
  if (id == 0u)
    return;
  vec4 light = texelFetch(light_image, texel, 0);
  float depth = view_depth(texelFetch(depth_image, texel, 0).r);
  if (!copy_only && depth > 0.0) {
    float scale = has_scatter_scale() ? clean_scatter_scale(texelFetch(scatter_scale_image, texel, 0).r) : 1.0;
    scatter_profile profile = find_profile(id, scale);
    if (projected_d(profile.d.w, depth) >= copy_below_d_px)
      light.rgb = scatter(scatter_point(pixel, id, depth, view_position(vec2(pixel), depth)), profile, light.a, light.rgb,
                          sample_set(0u, settings.samples, settings.samples, frame.frame_index * uint(settings.samples)));
  }
  imageStore(scattered_image, texel, vec4(round_to_half(light.rgb), 1.0));
}
