#version 460
// The last step up without a stored level 0: a pixel's own light at full resolution, and all light
// of other pixels from level 1. Patches ignore pixels beyond blocks of 4x2 pixels.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "sap/subsurface_sap_gather_half.bindings.glsl"
#include "common/environment.glsl"
#include "common/half.glsl"
#include "common/radius.glsl"
const int block_width = 4, block_height = 2, coarse_width = 4, coarse_height = 3, border = 0;
#define SAP_NO_RING
#include "sap/sap_up.glsl"

const int pixels_across = block_width, pixels_down = block_height, tile_pixels = 8;
#include "sap/sap_pixel_block.glsl"

void read_pixels(texel_block block) {
  [[unroll]] for (int k = 0; k < block_texels; ++k) {
    ivec2 pixel = block.first + block_offset(k);
    keep_pixel(texel_shape ? int(gl_LocalInvocationIndex) : k, pixel, inside_rect(pixel),
               !block.copy_only);
  }
}

vec4 gather(sap_place place, ivec2 in_block, vec3 light) {
  uint id = profile_at(pixel_index(in_block));
  float area_root;
  sap_texel own = surface_at(place.at, in_block, area_root);
  vec3 d_px = sap_d_px(own) * inversesqrt(area_root); // a tilted pixel keeps more of its own light
  vec3 centre = sap_lookup(id, sap_half, 0, d_px);
  float confidence;
  sap_sum rest = sap_from_coarser(place, 0, own, light, 1, confidence);
  rest.mass *= max(1.0 - centre, vec3(0.0));
  confidence = mix(confidence, 1.0, centre[profiles[min(id, 255u)].widest]);
  // Light that never scatters needs no surface around.
  vec3 direct = profile_direct(id);
  vec3 mean = sap_blend(max(centre - direct, vec3(0.0)), light, vec3(0.0), light, rest).light;
  return vec4(mix(mean, light, direct), confidence);
}

void main() {
  texel_block block;
  if (!listed_block(0, block))
    return;
  read_pixels(block);
  if (!block.copy_only)
    read_coarser(block, 0);
  finish_reading();
  [[unroll]] for (int k = 0; k < block_texels; ++k) {
    sap_place place = place_of(block, k, 0);
    if (!inside_rect(place.at))
      continue;
    ivec2 in_block = texel_shape ? block.first - 8 * block.tile : block_offset(k);
    vec4 result = vec4(0.0, 0.0, 0.0, 1.0);
    int i = pixel_index(in_block);
    if (profile_at(i) != 0u) {
      result.rgb = pixel_light(lighting_image, albedo_image, has_albedo(), settings.texturing,
                               texel_of(place.at));
      if (depth_at(i) > 0.0) {
        take_corners(k, 0);
        result = gather(place, in_block, result.rgb);
      }
    }
    imageStore(scattered_image, texel_of(place.at),
               settings.storage == STORAGE_FULL ? result : round_to_half(result));
  }
}
