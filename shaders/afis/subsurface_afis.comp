#version 460
// Filtered importance sampling with the same number of samples in all pixels.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "afis/subsurface_afis.bindings.glsl"
#include "common/environment.glsl"
#include "common/tiles.glsl"
#include "common/half.glsl"
#include "common/radius.glsl"
#include "afis/afis.glsl"

vec3 scatter_light(scatter_point point, scatter_profile profile, vec4 own, sample_set set) {
  afis_settings chosen = afis_settings(settings.lod_bias, settings.sequence, settings.channels,
                                       settings.inverse, settings.weighting, settings.surface,
                                       settings.direct, settings.estimator, settings.mips);
  return scatter(chosen, set, point, profile, own, material_image, depth_image, slope_image,
                 light_image, levels_image);
}

void main() {
  ivec2 pixel;
  bool copy_only;
  uint listed = listed_tile();
  if (listed >= tiles_data[0] || !pixel_of_tile(tiles_data[1u + listed], pixel, copy_only))
    return;
  ivec2 texel = texel_of(pixel);
  uint id = profile_of(texelFetch(material_image, texel, 0).r);
  if (id == 0u)
    return;
  vec4 light = texelFetch(light_image, texel, 0);
  float depth = view_depth(texelFetch(depth_image, texel, 0).r);
  if (!copy_only && depth > 0.0) {
    float scale = has_scatter_scale()
                      ? clean_scatter_scale(texelFetch(scatter_scale_image, texel, 0).r)
                      : 1.0;
    scatter_profile profile = find_profile(id, scale);
    if (projected_d(profile.d.w, depth) >= copy_below_d_px) {
      scatter_point point = scatter_point(pixel, id, depth, view_position(vec2(pixel), depth));
      uint first = frame.frame_index * uint(settings.samples);
      sample_set set = sample_set(0u, settings.samples, settings.samples, first);
      light.rgb = scatter_light(point, profile, light, set);
    }
  }
  imageStore(scattered_image, texel, vec4(round_to_half(light.rgb), 1.0));
}
