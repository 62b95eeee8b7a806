#version 460
// Computes the next coarser level.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "sap/subsurface_sap_down.bindings.glsl"
#include "common/environment.glsl"
#include "common/half.glsl"
#include "sap/sap_down.glsl"

void main() {
  int level = settings.level, finer = level - 1;
  texel_block block;
  if (!listed_block(level, block))
    return;
  if (texel_shape)
    read_tile(block, finer, false);
  else
    read_block(block, block.first - 1, finer);
  [[unroll]] for (int k = 0; k < block_texels; ++k) {
    sap_parent parent = take_parent(block, k, finer);
    if (!sap_inside(parent.at, level))
      continue;
    sap_layer layer = reduce(parent, 1, no_texel);
    imageStore(coarse_light_image, sap_address(parent.at, level), layer.light);
    imageStore(coarse_surface_image, sap_address(parent.at, level), layer.bits);
  }
}
