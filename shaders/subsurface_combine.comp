#version 460
// Scattered light back into the host's lighting, where there is subsurface.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "subsurface_combine.bindings.glsl"
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
  if (texelFetch(material_image, texel, 0).r == 0u)
    return;
  vec3 color = texelFetch(scattered_image, texel, 0).rgb;
  if (settings.result == RESULT_COLOR && settings.texturing != TEXTURING_PRE && has_albedo()) {
    vec3 albedo = clean_albedo(texelFetch(albedo_image, texel, 0).rgb);
    color *= settings.texturing == TEXTURING_POST ? albedo : sqrt(albedo);
  }
  imageStore(lighting_image, texel, vec4(round_to_half(color), 1.0));
}
