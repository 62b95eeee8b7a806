#version 460
// The last step up without a stored level 0: a pixel's own light at full resolution, and all light
// of other pixels from level 1. An invocation reads a block of pixels once; patches ignore pixels
// beyond the block.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "sap/subsurface_sap_gather_half.bindings.glsl"
#include "common/environment.glsl"
#include "common/half.glsl"
#include "common/radius.glsl"
const int block_width = 4, block_height = 2, coarse_width = 4, coarse_height = 3;
const ivec2 odd_first = ivec2(0);
#define SAP_NO_RING
#include "sap/sap_up.glsl"

const int pixels_across = block_width, pixels_down = block_height;
#include "sap/sap_pixel_block.glsl"

void read_pixels(texel_block block) {
  [[unroll]] for (int k = 0; k < block_pixels; ++k) {
    ivec2 pixel = block.first + ivec2(k % block_width, k / block_width), texel = texel_of(pixel);
    uint id = 0u;
    float depth = 0.0;
    if (inside_rect(pixel))
      id = texelFetch(material_image, texel, 0).r;
    if (id != 0u && !block.copy_only)
      depth = view_depth(texelFetch(depth_image, texel, 0).r);
    pixel_profile[k] = id;
    pixel_depth[k] = depth;
  }
}

vec4 gather(int k, ivec2 pixel, vec3 light) {
  take_corners(k);
  uint id = pixel_profile[k];
  float area_root;
  sap_texel own = block_surface(pixel, k, area_root);
  vec3 d_px = sap_d_px(own) * inversesqrt(area_root); // a tilted pixel keeps more of its own light
  vec3 centre = sap_lookup(id, sap_half, 0, d_px);
  float confidence;
  sap_sum rest = sap_from_coarser(odd_of(k), 0, own, light, 1, confidence);
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
    read_coarser(block.first, 0);
  [[unroll]] for (int k = 0; k < block_pixels; ++k) {
    ivec2 pixel = block.first + ivec2(k % block_width, k / block_width);
    if (!inside_rect(pixel))
      continue;
    vec4 result = vec4(0.0, 0.0, 0.0, 1.0);
    if (pixel_profile[k] != 0u) {
      result.rgb = pixel_light(lighting_image, albedo_image, has_albedo(), settings.texturing,
                               texel_of(pixel));
      if (pixel_depth[k] > 0.0)
        result = gather(k, pixel, result.rgb);
    }
    imageStore(scattered_image, texel_of(pixel), settings.storage == STORAGE_FULL ? result : round_to_half(result));
  }
}
