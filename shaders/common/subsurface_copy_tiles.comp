#version 460
// Copies light unchanged if nothing on the screen scatters further than a pixel, or if light is
// uniform everywhere.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "common/subsurface_copy_tiles.bindings.glsl"
#include "common/environment.glsl"
#include "common/tiles.glsl"
#include "common/half.glsl"
#include "common/pixel_light.glsl"

void main() {
  ivec2 pixel;
  bool copy_only;
  uint listed = listed_tile();
  if (listed >= tiles_data[0] || !pixel_of_tile(tiles_data[1u + listed], pixel, copy_only))
    return;
  ivec2 texel = texel_of(pixel);
  vec3 light = pixel_light(lighting_image, albedo_image, has_albedo(), settings.texturing, texel);
  imageStore(scattered_image, texel, vec4(round_to_half(light), 1.0));
}
