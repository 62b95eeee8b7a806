#version 460
// Computes the next coarser level, with a second layer where one surface does not hold all
// children. First computes parents in groups of four that share their children. Then recomputes,
// one by one and from both layers, the parents with a child off their surface or with a child that
// has two layers.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "sap/subsurface_sap_down_layered.bindings.glsl"
#include "common/environment.glsl"
#include "common/half.glsl"
#define SAP_SECOND
#include "sap/sap_down.glsl"

// Reads both layers of the children of a parent.
void read_children(texel_block block, ivec2 parent, int finer) {
  [[unroll]] for (int c = 0; c < children_a_layer; ++c) {
    ivec2 at = 2 * parent - 1 + ivec2(c % children_across, c / children_across);
    bool needed = child_written(block, at, finer);
    uvec4 bits = needed ? texelFetch(surface_image, sap_address(at, finer), 0) : uvec4(0u);
    children[c] = sap_unpack(bits);
    child_light[c] = needed ? texelFetch(light_image, sap_address(at, finer), 0) : vec4(0.0);
    needed = needed && sap_has_second(bits) && has_second_surface() && has_second_light();
    int second = children_a_layer + c;
    children[second] = sap_unpack(needed ? texelFetch(second_surface_image, sap_address(at, finer), 0) : uvec4(0u));
    child_light[second] = needed ? texelFetch(second_light_image, sap_address(at, finer), 0) : vec4(0.0);
  }
}

void main() {
  int level = settings.level, finer = level - 1;
  texel_block block;
  if (!listed_block(level, block))
    return;
  ivec2 first = block.first - 1;
  float spacing = float(1 << finer);
  read_block(block, first, finer);
  uint layered = 0u; // bit k: parent k needs more than one layer
  [[unroll]] for (int k = 0; k < block_width * block_height; ++k) {
    ivec2 at = first + ivec2(k % block_width, k / block_width);
    if (!sap_inside(at, level))
      continue;
    bool more = take_children(k);
    begin_parent(1);
    vec4 light;
    uvec4 bits;
    reduce(spacing, 1, light, bits);
    layered |= more || remains(1) ? 1u << k : 0u;
    imageStore(coarse_light_image, sap_address(at, level), stored(light));
    imageStore(coarse_surface_image, sap_address(at, level), bits);
  }
  // The loops test at their end, because some drivers execute the body of a loop before they find
  // that no invocation is active.
  if (layered != 0u)
    do {
      int k = findLSB(layered);
      ivec2 at = first + ivec2(k % block_width, k / block_width);
      read_children(block, at, finer);
      begin_parent(max_layers);
      uvec4 first_bits = uvec4(0u);
      int layer = 0, layers = layered != 0u ? max_layers : 1;
      [[dont_unroll]] do {
        vec4 light;
        uvec4 bits;
        reduce(spacing, max_layers, light, bits);
        if (layer == 0) {
          first_bits = bits;
          imageStore(coarse_light_image, sap_address(at, level), stored(light));
        } else if (bits.w != 0u) {
          first_bits.w |= sap_second_bit;
          imageStore(second_coarse_light_image, sap_address(at, level), stored(light));
          imageStore(second_coarse_surface_image, sap_address(at, level), bits);
        }
      } while (++layer < layers);
      imageStore(coarse_surface_image, sap_address(at, level), first_bits);
      layered &= layered - 1u;
    } while (layered != 0u);
}
