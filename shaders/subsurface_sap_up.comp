#version 460
// One level up: its own light and what the coarser level hands down, blended by the profile's shares. A block's four
// texels lie on the same four of the coarser level.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "subsurface_sap_up.bindings.glsl"
#include "environment.glsl"
#include "half.glsl"
const int block_width = 2, block_height = 2, coarse_width = 2, coarse_height = 2, odd_first = 1;
#include "sap_up.glsl"

const float least_share = 0.004; // below it the tent is not worth its time

void main() {
  int level = settings.level;
  texel_block block;
  if (!listed_block(level, block))
    return;
  ivec2 first = block.first - 1;
  bool smooth_level = settings.variant == VARIANT_SMOOTH || level == 1, last = !has_coarse_scattered();
  read_ring(block, first, level, smooth_level);
  if (!last)
    read_coarser(first, level);
  [[unroll]] for (int k = 0; k < block_texels; ++k) {
    ivec2 at = first + ivec2(k % block_width, k / block_width);
    if (!sap_inside(at, level))
      continue;
    sap_texel own = sap_own(k);
    uvec4 bits = uvec4(0u);
    if (own.id != 0u) {
      vec3 share = last ? vec3(1.0) : sap_lookup(own.id, settings.variant, level + 1, sap_d_px(own));
      sap_sum here = sap_sum(sap_own_light(k), vec3(own.mass));
      if (smooth_level && max(share.r, max(share.g, share.b)) >= least_share)
        here = sap_tent(k, level, own);
      float confidence = 0.0;
      sap_sum rest = sap_sum(here.light, vec3(0.0));
      if (!last)
        rest = sap_from_coarser(k, level, own, here.light, confidence);
      rest.mass *= 1.0 - share;
      sap_sum blend = sap_blend(share * here.mass, here.light, vec3(0.0), here.light, rest);
      float widest = share[profiles[min(own.id, 255u)].widest];
      float sure = mix(confidence, here.mass.r, widest);
      bits = settings.storage == STORAGE_FULL
                 ? sap_pack_scattered_full(sap_scattered(blend.light, sure, blend.mass))
                 : sap_pack_scattered(sap_scattered(round_to_half(blend.light), round_to_half(sure), round_to_half(blend.mass)));
    }
    imageStore(scattered_image, sap_address(at, level), bits);
  }
}
