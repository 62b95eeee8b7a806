#version 460
// Computes the next coarser level, with a second layer where one surface does not hold all
// children; at level 1 only next to another surface, and only if the images of the second layer are
// bound. First computes one layer of each parent from the first layer of its children. Then
// recomputes, from both layers, the parents with a child off their surface or with a child that has
// two layers.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "sap/subsurface_sap_down.bindings.glsl"
#include "sap/sap_blocks.glsl"
#include "sap/sap_down_layers.glsl"
#include "sap/sap_ordered_sums.glsl"
#include "sap/sap_rounds.glsl"
#include "sap/sap_tile_children.glsl"

bool stores_full() { return settings.storage == STORAGE_FULL; }
uvec2 level_tiles_at(uint index) { return level_tiles_data[index]; }

// Texel shape: the children of the group's tile.
shared uvec4 tile_surface[texel_shape ? tile_texels : 1];
shared uint tile_light[texel_shape ? tile_texels : 1];
bool keeps_second() { return false; }
void keep_child(int place, uvec4 surface, uint light) {
  tile_surface[place] = surface;
  tile_light[place] = light;
}
uvec4 kept_surface(int place) { return tile_surface[place]; }
uint kept_light(int place) { return tile_light[place]; }

bool is_computed(int finer) { return false; }
uvec4 finer_surface(ivec2 address, int layer, int finer, bool computed) {
  return layer == 0 ? texelFetch(surface_image, address, 0)
                    : texelFetch(second_surface_image, address, 0);
}
vec4 finer_light(ivec2 address, int layer, int finer, bool computed, uvec4 bits) {
  return sap_stored_light(bits, layer == 0 ? texelFetch(light_image, address, 0)
                                           : texelFetch(second_light_image, address, 0));
}
bool finer_has_layers() { return has_second_surface() && has_second_light(); }
bool finer_has_second(uvec4 bits, bool computed) {
  return sap_has_second(bits) && finer_has_layers();
}

// Block shape: the children of a block, and of a parent; its second layer follows the first.
const int side = 6, parent_children = 16;
uvec4 block_surface[side * side];
vec4 block_light[side * side];
sap_texel children[2 * parent_children];
vec4 child_light[2 * parent_children];

int children_across() { return 4; }
bool shares_children() { return texel_shape; }
sap_texel child_of(sap_parent parent, int c, bool second) {
  if (texel_shape)
    return sap_unpack(surface_in_tile(parent, c, second));
  return children[second ? parent_children + c : c];
}
vec4 light_of(sap_parent parent, int c, bool second, uint id) {
  if (texel_shape)
    return light_in_tile(parent, c, second, id);
  return child_light[second ? parent_children + c : c];
}

// Block shape: reads the children of all parents of a block, starting at parent `first`.
void read_block(texel_block block, ivec2 first, int finer) {
  [[unroll]] for (int i = 0; i < side * side; ++i) {
    ivec2 at = step_from_level(finer) * first - 1 + ivec2(i % side, i / side);
    bool needed = child_written(block, at, finer);
    block_surface[i] = needed ? finer_surface(sap_address(at, finer), 0, finer, false) : uvec4(0u);
    block_light[i] = needed ? finer_light(sap_address(at, finer), 0, finer, false, block_surface[i])
                            : vec4(0.0);
  }
}
// Block shape: prepares the first layer of the children of parent k.
sap_parent take_parent(texel_block block, int k, int finer) {
  sap_parent parent = parent_at(block.first - 1 + block_offset(texel_blocks, k), finer);
  uint flags = 0u;
  [[unroll]] for (int c = 0; c < parent_children; ++c) {
    int i = shared_child(k, c, finer);
    children[c] = sap_unpack(block_surface[i]);
    child_light[c] = block_light[i];
    flags |= block_surface[i].x;
  }
  note_layers(flags, parent);
  return parent;
}
// Block shape: reads both layers of the children of parent k.
sap_parent read_children(texel_block block, int k, int finer) {
  sap_parent parent = parent_at(block.first - 1 + block_offset(texel_blocks, k), finer);
  parent.two = true;
  [[unroll]] for (int c = 0; c < parent_children; ++c) {
    ivec2 address = address_of_child(parent, c);
    ivec2 at = step_from_level(finer) * parent.at - 1 + ivec2(c & 3, c >> 2);
    bool needed = child_written(block, at, finer);
    uvec4 bits = needed ? finer_surface(address, 0, finer, false) : uvec4(0u);
    children[c] = sap_unpack(bits);
    child_light[c] = needed ? finer_light(address, 0, finer, false, bits) : vec4(0.0);
    needed = needed && finer_has_second(bits, false);
    int second = parent_children + c;
    bits = needed ? finer_surface(address, 1, finer, false) : uvec4(0u);
    children[second] = sap_unpack(bits);
    child_light[second] = needed ? finer_light(address, 1, finer, false, bits) : vec4(0.0);
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

// Block shape: computes both layers of a parent. The loop tests at its end, because some drivers
// execute the body of a loop before they find that no invocation is active.
void compute_both(sap_parent parent, int level, bool computes) {
  sap_texel before = no_texel;
  sap_layer first;
  int index = 0, count = computes && writes_second() ? 2 : 1;
  [[dont_unroll]] do {
    sap_layer layer = reduce(parent, 2, before);
    before = layer.seed;
    if (index == 0) {
      first = layer;
    } else if (layer.bits.w != 0u) {
      first.bits = with_second(first.bits, change_of_first(layer));
      store_layer(parent, level, true, layer);
    }
  } while (++index < count);
  store_layer(parent, level, false, first);
}

void main() {
  int level = settings.level, finer = level - 1;
  texel_block block;
  if (texel_shape) {
    if (!listed_block(texel_blocks, level, gl_LocalInvocationIndex, block))
      return;
    read_tile(block, finer, false, 64);
    compute_parent(parent_in_tile(block, finer), level);
    return;
  }
  begin_rounds();
  uint layered = 0u; // bit 4 r + k: parent k of round r needs more than one layer
  [[dont_unroll]] for (int round = 0; round < block_rounds; ++round) {
    if (!listed_block(texel_blocks, level, block_of_round(round), block))
      continue;
    read_block(block, block.first - 1, finer);
    [[unroll]] for (int k = 0; k < block_texels(texel_blocks); ++k) {
      sap_parent parent = take_parent(block, k, finer);
      if (!sap_inside(parent.at, level))
        continue;
      sap_layer layer = reduce(parent, 1, no_texel);
      bool again = parent.two || layer.remains && parent.splits && writes_second();
      layered |= again ? 1u << (4 * round + k) : 0u;
      if (!again)
        store_layer(parent, level, false, layer);
    }
  }
  finish_rounds(layered);
  uint i = gl_LocalInvocationIndex;
  if (i < count_again())
    do {
      uint next = texel_again(i);
      block = known_block(texel_blocks, level, next >> 2);
      sap_parent parent = read_children(block, int(next & 3u), finer);
      compute_both(parent, level, i < count_again());
      i += round_lanes;
    } while (i < count_again());
}
