#version 460
// Blends samples into the pyramid's light where confidence is low. Uses no history.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "papers/subsurface_refine.bindings.glsl"
#include "common/environment.glsl"
#include "common/tiles.glsl"
#include "common/half.glsl"
#include "sap/sap.glsl"
bool near_written(ivec2 at) { return class_of_tile(classes_data[sap_tile(at)]) != class_none; }
#include "sap/sap_samples.glsl"

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
      vec3 sampled = sap_sampled_light(pixel, own, pixel_light_of_level_0(texel), offset,
                                       count, settings.lod_bias);
      float fraction = sample_fraction(light.a, float(count), settings.sample_weight);
      light.rgb = round_to_half(mix(light.rgb, sampled, fraction));
    }
  }
  imageStore(blended_image, texel, light);
  if (has_sampling())
    imageStore(sampling_image, texel, vec4(float(count), 0.0, light.a, 0.0));
}
