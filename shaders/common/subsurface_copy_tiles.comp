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
  if (!listed_pixel(pixel, copy_only))
    return;
  ivec2 texel = texel_of(pixel);
  imageStore(scattered_image, texel, vec4(round_to_half(pixel_light(texel)), 1.0));
}
