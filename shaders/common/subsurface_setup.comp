#version 460
// Writes the light that can scatter and the slope of its surface.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "common/subsurface_setup.bindings.glsl"
#include "common/environment.glsl"
#include "common/tiles.glsl"
#include "common/half.glsl"
#include "common/pixel_light.glsl"
#include "common/shared_patch.glsl"

void main() {
  uint tile = listed_tile();
  ivec2 pixel = ivec2(0);
  bool copy_only = false;
  bool listed = tile < tiles_data[0] && pixel_of_tile(tiles_data[1u + tile], pixel, copy_only);
  share_patches(material_image, depth_image, pixel - ivec2(gl_LocalInvocationID.xy));
  if (!listed)
    return;
  ivec2 texel = texel_of(pixel);
  uint id = own_profile();
  vec4 light = vec4(0.0);
  vec2 slope = vec2(0.0);
  if (id != 0u) {
    light.rgb = pixel_light(lighting_image, albedo_image, has_albedo(), settings.texturing, texel);
    float depth = own_depth();
    light.a = 1.0;
    if (depth > 0.0 && !copy_only) {
      surface_patch surface = build_patch(pixel);
      light.a = surface.footprints;
      slope = surface.slope;
    }
  }
  imageStore(light_image, texel, round_to_half(light));
  if (has_slope())
    imageStore(slope_image, texel, vec4(round_to_half(vec3(slope, 0.0)), 0.0));
}
