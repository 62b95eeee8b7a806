#version 460
// Computes level 0 of the plain pyramid: light with a mask or view depth, and zeros outside the
// rectangle.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "afis/subsurface_pyramid_setup.bindings.glsl"
#include "common/constants_math.glsl"
#include "common/environment.glsl"
#include "common/half.glsl"
#include "common/pixel_light.glsl"
#include "afis/pyramid.glsl"

layout(local_size_x = 8, local_size_y = 8, local_size_z = 1) in;

bool beside_another_profile(ivec2 pixel, uint id) {
  for (int y = -1; y <= 1; ++y)
    for (int x = -1; x <= 1; ++x) {
      ivec2 q = pixel + ivec2(x, y);
      if (!inside_rect(q))
        continue;
      uint other = profile_of(texelFetch(material_image, texel_of(q), 0).r);
      if (other != 0u && other != id)
        return true;
    }
  return false;
}

void main() {
  ivec2 address = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(address, imageSize(level_0_image))))
    return;
  ivec2 pixel = address - (settings.borders == BORDERS_NONE ? 0 : pyramid_border);
  vec4 light = vec4(0.0);
  if (inside_rect(pixel)) {
    ivec2 texel = texel_of(pixel);
    uint id = profile_of(texelFetch(material_image, texel, 0).r);
    if (id != 0u) {
      light.rgb =
          pixel_light(lighting_image, albedo_image, has_albedo(), settings.texturing, texel);
      light.a = 1.0;
      if (settings.profiles == PROFILES_APART)
        light.a = beside_another_profile(pixel, id) ? mixed_mask : apart_scale;
      if (settings.alpha == ALPHA_DEPTH && has_depth())
        light.a = view_depth(texelFetch(depth_image, texel, 0).r) / mm_per_metre;
    }
  }
  imageStore(level_0_image, address, round_to_half(light));
}
