#version 460
// Blends samples into the pyramid's light where confidence is low. Uses no history.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "papers/subsurface_refine.bindings.glsl"
#include "common/environment.glsl"
#include "common/tiles.glsl"
#include "common/half.glsl"
#include "sap/sap_samples.glsl"

bool near_written(ivec2 at) { return class_of_tile(classes_data[sap_tile(at)]) != class_none; }
uvec4 level_surface(int level, ivec2 address) {
  return fetch_level(surface_1_image, surface_2_image, surface_3_image, surface_4_image,
                     surface_5_image, level, address);
}
vec4 level_light(int level, ivec2 address) {
  return fetch_level(light_1_image, light_2_image, light_3_image, light_4_image, light_5_image,
                     level, address);
}

void main() {
  ivec2 pixel;
  bool copy_only;
  uint listed = listed_tile();
  if (listed >= tiles_data[0] || !pixel_of_tile(tiles_data[1u + listed], pixel, copy_only))
    return;
  ivec2 texel = texel_of(pixel);
  vec4 light = texelFetch(scattered_image, texel, 0);
  int count = !copy_only && light.a < settings.below ? settings.samples : 0;
  if (count > 0) {
    sap_texel own = sap_unpack(texelFetch(surface_image, texel, 0));
    if (own.id == 0u) {
      count = 0;
    } else {
      uvec2 offset = r2_point(offset_from_hash(pcg3d16(uvec3(pixel, 0u)).xy), frame.frame_index);
      vec3 own_light = pixel_light_of_level_0(surface_image, light_image, texel);
      vec3 sampled = sap_sampled_light(surface_image, light_image, pixel, own, own_light, offset,
                                       count, settings.lod_bias);
      float fraction = sample_fraction(light.a, float(count), settings.sample_weight);
      light.rgb = round_to_half(mix(light.rgb, sampled, fraction));
    }
  }
  imageStore(blended_image, texel, light);
  if (has_sampling())
    imageStore(sampling_image, texel, vec4(float(count), 0.0, light.a, 0.0));
}
