#version 460
// Where nothing on the screen scatters further than a pixel, or light is flat everywhere, light passes as it is.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "subsurface_copy.bindings.glsl"
#include "environment.glsl"
#include "tiles.glsl"
#include "half.glsl"
#include "sanitise.glsl"

void main() {
  ivec2 pixel;
  bool copy_only;
  if (!listed_pixel(pixel, copy_only))
    return;
  ivec2 texel = texel_of(pixel);
  vec3 light = clean_light(texelFetch(lighting_image, texel, 0).rgb);
  if (settings.texturing != TEXTURING_POST && has_albedo()) {
    vec3 albedo = clean_albedo(texelFetch(albedo_image, texel, 0).rgb);
    light *= settings.texturing == TEXTURING_PRE ? albedo : sqrt(albedo);
  }
  imageStore(scattered_image, texel, vec4(round_to_half(light), 1.0));
}
