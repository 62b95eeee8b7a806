#version 460
// Writes unscattered light into the host's lighting, rounded as scattered light is rounded. Runs if
// no tile scatters; otherwise the pyramid's last step also copies.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "common/subsurface_combine_copies.bindings.glsl"
#include "common/environment.glsl"
#include "common/tiles.glsl"
#include "common/combined_light.glsl"
#include "common/half.glsl"
#include "common/pixel_light.glsl"

void main() {
  ivec2 pixel;
  bool copy_only, full;
  uint listed = listed_tile();
  if (listed >= tiles_data[0] || !pixel_of_tile(tiles_data[1u + listed], pixel, copy_only, full))
    return;
  ivec2 texel = texel_of(pixel);
  bool subsurface = full;
  if (!full)
    subsurface = texelFetch(material_image, texel, 0).r != 0u;
  if (!subsurface)
    return;
  vec3 light = pixel_light(lighting_image, albedo_image, has_albedo(), settings.texturing, texel);
  vec3 albedo =
      combined_albedo(albedo_image, has_albedo(), settings.texturing, settings.result, texel);
  imageStore(lighting_out_image, texel,
             combined_light(settings.texturing, settings.result, albedo, round_to_half(light)));
}
