#version 460
// Computes the next coarser level, with a second layer where one surface does not hold all
// children; at level 1 only next to another surface, and only if the images of the second layer are
// bound. First computes one layer of each parent from the first layer of its children. Then
// recomputes, from both layers, the parents with a child off their surface or with a child that has
// two layers.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "sap/subsurface_sap_down.bindings.glsl"
#include "common/environment.glsl"
#include "common/half.glsl"
#define SAP_SECOND
#include "sap/sap_down.glsl"

// Block shape: reads both layers of the children of parent k.
sap_parent read_children(texel_block block, int k, int finer) {
  sap_parent parent = parent_at(block.first - 1 + block_offset(k), finer);
  parent.two = true;
  [[unroll]] for (int c = 0; c < children_a_layer; ++c) {
    ivec2 address = address_of_child(parent, c);
    ivec2 at = step_from_level(finer) * parent.at - 1 + ivec2(c & 3, c >> 2);
    bool needed = child_written(block, at, finer);
    uvec4 bits = needed ? texelFetch(surface_image, address, 0) : uvec4(0u);
    children[c] = sap_unpack(bits);
    child_light[c] = needed ? finer_light(address, finer, false, bits) : vec4(0.0);
    needed = needed && finer_has_second(bits, false);
    int second = children_a_layer + c;
    bits = needed ? second_finer_surface(address, finer, false) : uvec4(0u);
    children[second] = sap_unpack(bits);
    child_light[second] = needed ? second_finer_light(address, finer, false, bits) : vec4(0.0);
  }
  return parent;
}

bool writes_second() { return has_second_coarse_light() && has_second_coarse_surface(); }
void store_layer(sap_parent parent, int level, bool second, sap_layer layer) {
  ivec2 address = sap_address(parent.at, level);
  if (second) {
    imageStore(second_coarse_light_image, address, layer.light);
    imageStore(second_coarse_surface_image, address, layer.bits);
  } else {
    imageStore(coarse_light_image, address, layer.light);
    imageStore(coarse_surface_image, address, layer.bits);
  }
}
#include "sap/sap_down_layers.glsl"

void main() {
  int level = settings.level, finer = level - 1;
  texel_block block;
  if (!listed_block(level, block))
    return;
  if (texel_shape) {
    read_tile(block, finer, false);
    compute_parent(take_parent(block, 0, finer), level);
    return;
  }
  read_block(block, block.first - 1, finer);
  uint layered = 0u; // bit k: parent k needs more than one layer
  [[unroll]] for (int k = 0; k < block_width * block_height; ++k) {
    sap_parent parent = take_parent(block, k, finer);
    if (!sap_inside(parent.at, level))
      continue;
    sap_layer layer = reduce(parent, 1, no_texel);
    layered |=
        parent.two || layer.remains && parent.splits && writes_second() ? 1u << k : 0u;
    store_layer(parent, level, false, layer);
  }
  if (layered != 0u)
    do {
      sap_parent parent = read_children(block, findLSB(layered), finer);
      compute_both(parent, level, layered != 0u);
      layered &= layered - 1u;
    } while (layered != 0u);
}
