#version 460
// Computes the next coarser level. The four parents of a block share their children.
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
  ivec2 first = block.first - 1;
  float spacing = float(1 << finer);
  read_block(block, first, finer);
  [[unroll]] for (int k = 0; k < block_width * block_height; ++k) {
    ivec2 at = first + ivec2(k % block_width, k / block_width);
    if (!sap_inside(at, level))
      continue;
    take_children(k);
    begin_parent(1);
    vec4 light;
    uvec4 bits;
    reduce(spacing, 1, light, bits);
    imageStore(coarse_light_image, sap_address(at, level), stored(light));
    imageStore(coarse_surface_image, sap_address(at, level), bits);
  }
}
