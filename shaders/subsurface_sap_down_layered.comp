#version 460
// One level down, two layers a texel.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "subsurface_sap_down_layered.bindings.glsl"
#include "environment.glsl"
#include "half.glsl"
#define SAP_LAYERS 2
#include "sap_down.glsl"

void main() {
  int level = settings.level, finer = level - 1;
  texel_block block;
  if (!listed_block(level, block))
    return;
  float spacing = float(1 << finer);
  [[dont_unroll]] for (int k = 0; k < block_width * block_height; ++k) {
    ivec2 at = block.first - 1 + ivec2(k % block_width, k / block_width);
    if (!sap_inside(at, level))
      continue;
    read_children(block, at, finer);
    [[unroll]] for (int c = 0; c < child_count; ++c)
      child_left[c] = 1.0;
    [[dont_unroll]] for (int layer = 0; layer < SAP_LAYERS; ++layer) {
      vec4 light = vec4(0.0);
      uvec4 bits = uvec4(0u);
      bool remains = false;
      [[unroll]] for (int c = 0; c < child_count; ++c)
        remains = remains || may_seed(0, c);
      for (uint left = remains ? 1u : 0u; left != 0u; --left) // once or not at all: some drivers run both sides of a branch
        reduce(0, spacing, light, bits);
      light = settings.storage == STORAGE_FULL ? light : round_to_half(light);
      if (layer == 0) {
        imageStore(coarse_light_image, sap_address(at, level), light);
        imageStore(coarse_surface_image, sap_address(at, level), bits);
      } else {
        imageStore(second_coarse_light_image, sap_address(at, level), light);
        imageStore(second_coarse_surface_image, sap_address(at, level), bits);
      }
    }
  }
}
