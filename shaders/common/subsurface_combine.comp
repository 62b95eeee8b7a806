#version 460
// Writes scattered light back into the host's lighting where there is subsurface.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "common/subsurface_combine.bindings.glsl"
#include "common/environment.glsl"
#include "common/tiles.glsl"
#include "common/combined_light.glsl"

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
  vec3 albedo =
      combined_albedo(albedo_image, has_albedo(), settings.texturing, settings.result, texel);
  vec3 color = vec3(0.0);
  bool copies =
      has_unscattered() && (copy_only && settings.copied == COPIED_UNSCATTERED || !has_scattered());
  // Rounds as scattered light is rounded.
  if (copies) {
    color = clean_light(texelFetch(unscattered_image, texel, 0).rgb);
    color = round_to_half(clean_light(apply_albedo_before(settings.texturing, albedo, color)));
  } else {
    color = texelFetch(scattered_image, texel, 0).rgb;
  }
  imageStore(lighting_image, texel,
             combined_light(settings.texturing, settings.result, albedo, color));
}
