#version 460
// One level up, two layers a texel: its own light and what the coarser level hands down, blended by the profile's shares.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "subsurface_sap_up_layered.bindings.glsl"
#include "environment.glsl"
#include "half.glsl"
#define SAP_OWN_LAYERS 2
#define SAP_COARSE_LAYERS 2
#define SAP_TEXELS_ACROSS 1 // one at a time, else the kernel takes long to compile
#define SAP_TEXELS_DOWN 1
#include "sap_climb.glsl"

void main() {
  int level = settings.level;
  texel_block block;
  if (!listed_block(level, block))
    return;
  bool smooth_level = settings.variant == VARIANT_SMOOTH || level == 1, last = !has_coarse_scattered();
  [[dont_unroll]] for (int k = 0; k < block_width * block_height; ++k) {
    texel_block one = block;
    one.first += ivec2(k % block_width, k / block_width);
    ivec2 at = one.first - 1;
    if (!sap_inside(at, level))
      continue;
    odd_first = at & 1;
    read_ring(one, at, level, smooth_level);
    if (!last)
      read_coarser(at, level);
    [[dont_unroll]] for (int layer = 0; layer < SAP_OWN_LAYERS; ++layer) {
      sap_texel own = sap_own(0);
      vec3 light = sap_own_light(0);
      if (layer > 0) {
        own = sap_second(0);
        light = sap_second_light(0);
      }
      uvec4 bits = uvec4(0u);
      for (uint left = own.id != 0u ? 1u : 0u; left != 0u; --left) // once or not at all, as on the way down
        bits = climb(0, level, own, light, smooth_level, last);
      if (layer == 0)
        imageStore(scattered_image, sap_address(at, level), bits);
      else
        imageStore(second_scattered_image, sap_address(at, level), bits);
    }
  }
}
