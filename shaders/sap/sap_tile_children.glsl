// The 18x18 children of a tile on the way down, which a group reads into shared memory. The kernel
// owns this memory, because it also holds the second layers of the children or not.
#ifndef DERMIS_SAP_TILE_CHILDREN_GLSL
#define DERMIS_SAP_TILE_CHILDREN_GLSL

#include "sap/sap_children.glsl"
#include "sap/sap_storage.glsl"
#include "sap/sap_tiles.glsl"

// Children are in rows with the even columns first: invocations next to each other read words next
// to each other.
const int tile_side = 18, tile_texels = tile_side * tile_side;

// The kernel that includes this file defines the next eight functions.
// Returns whether the same dispatch computes the finer level.
bool is_computed(int finer);
// Return the surface and light of a layer (0 or 1) of a texel of the finer level at an address in
// its image. `bits`: its surface. `computed`: is_computed().
uvec4 finer_surface(ivec2 address, int layer, int finer, bool computed);
vec4 finer_light(ivec2 address, int layer, int finer, bool computed, uvec4 bits);
// Returns whether the second layer of a texel of the finer level can be read.
bool finer_has_second(uvec4 bits, bool computed);
// Returns whether shared memory also holds second layers: tile_texels places after the first ones.
bool keeps_second();
// Write and read a child in shared memory. Light: r and g as halves, not read if light is stored as
// floats.
void keep_child(int place, uvec4 surface, uint light);
uvec4 kept_surface(int place);
uint kept_light(int place);

int place_in_tile(int x, int y) { return y * tile_side + (x >> 1) + tile_side / 2 * (x & 1); }
// Return the position of texel i of the tile, row by row, and its place. Division by 18 for
// numbers below 512, because some GPUs multiply 32 bits slowly.
ivec2 in_tile(int i) {
  int y = (i & 511) * 57 >> 10;
  return ivec2(i - (y << 4) - (y << 1), y);
}
int place_of_texel(int i) {
  int x = in_tile(i).x;
  return i - x + (x >> 1) + tile_side / 2 * (x & 1);
}
int place_of_child(sap_parent parent, int c) {
  if (!square_pixels) // the first child may be in an odd column
    return place_in_tile((parent.base & 31) + (c & 3), (parent.base >> 5) + (c >> 2 & 3));
  return parent.base + (c >> 2 & 3) * tile_side + ((c & 3) >> 1) + tile_side / 2 * (c & 1);
}
ivec2 address_of_child(sap_parent parent, int c) {
  return sap_address(step_from_level(parent.finer) * parent.at - 1 + ivec2(c & 3, c >> 2 & 3),
                     parent.finer);
}

bool child_written(texel_block block, ivec2 at, int finer) {
  ivec2 address = finer > 0 ? at + 1 : at;
  ivec2 tile = (address >> 3) - step_from_level(finer) * block.tile + 1;
  bool written = tile_written(block.children, tile);
  if (!square_pixels)
    written = written && max(tile.x, tile.y) <= 2;
  return all(bvec2(sap_inside(at, finer), written));
}
// Reads the children of all parents of the tile, by the `lanes` invocations of the group. An
// invocation first loads several children, so that it waits for memory once; it does not branch
// around children that were not written, but reads others instead.
void read_tile(texel_block block, int finer, bool computed, int lanes) {
  const int batch = 3;
  ivec2 corner = step_from_level(finer) * (8 * block.tile - 1) - 1;
  int lane = int(gl_LocalInvocationIndex);
  // Whole rows, so that the children of an invocation are in one column.
  bool whole_rows = lanes >= tile_side;
  int step = whole_rows ? lanes - lanes % tile_side : lanes;
  [[dont_unroll]] for (int first = lane < step ? lane : tile_texels; first < tile_texels;
                       first += batch * step) {
    ivec2 start = in_tile(first);
    int start_place = place_of_texel(first), place[batch];
    ivec2 address[batch];
    bool needed[batch];
    uvec4 bits[batch];
    vec4 light[batch];
    [[unroll]] for (int k = 0; k < batch; ++k) {
      int i = first + k * step;
      ivec2 offset = whole_rows ? start + ivec2(0, k * (step / tile_side)) : in_tile(i);
      ivec2 at = corner + offset;
      place[k] = whole_rows ? start_place + k * step : place_of_texel(i);
      needed[k] = all(bvec2(i < tile_texels, child_written(block, at, finer)));
      address[k] = needed[k] ? sap_address(at, finer) : ivec2(0);
      bits[k] = finer_surface(address[k], 0, finer, computed);
      light[k] = finer_light(address[k], 0, finer, computed, bits[k]);
    }
    [[unroll]] for (int k = 0; k < batch; ++k)
      if (first + k * step < tile_texels)
        keep_child(place[k], needed[k] ? bits[k] : uvec4(0u),
                   needed[k] ? packHalf2x16(light[k].rg) : 0u);
    if (keeps_second()) {
      [[unroll]] for (int k = 0; k < batch; ++k) {
        needed[k] = all(bvec2(needed[k], finer_has_second(bits[k], computed)));
        address[k] = mix(ivec2(0), address[k], bvec2(needed[k]));
        bits[k] = finer_surface(address[k], 1, finer, computed);
        light[k] = finer_light(address[k], 1, finer, computed, bits[k]);
      }
      [[unroll]] for (int k = 0; k < batch; ++k)
        if (first + k * step < tile_texels)
          keep_child(tile_texels + place[k], needed[k] ? bits[k] : uvec4(0u),
                     needed[k] ? packHalf2x16(light[k].rg) : 0u);
    }
  }
  barrier();
}

// Says which layers a parent may have. `flags`: union of the surfaces of its children.
void note_layers(uint flags, inout sap_parent parent) {
  parent.two = finer_has_second(uvec4(flags), is_computed(parent.finer));
  parent.splits = parent.finer > 0 || sap_has_second(uvec4(flags));
}
// Prepares the parent at the texel of `block`, whose children are in shared memory.
sap_parent parent_in_tile(texel_block block, int finer) {
  sap_parent parent = parent_at(block.first - 1, finer);
  ivec2 first = step_from_level(finer) * (block.first - 8 * block.tile);
  parent.base = square_pixels ? place_in_tile(first.x, first.y) : first.x | first.y << 5;
  uint flags = 0u;
  [[unroll]] for (int c = 0; c < 16; ++c)
    flags |= kept_surface(place_of_child(parent, c)).x;
  note_layers(flags, parent);
  return parent;
}

// Return the surface and light of child c, of its second layer if `second`. The surface is 0 if
// there is none. `id`: its profile.
uvec4 surface_in_tile(sap_parent parent, int c, bool second) {
  if (keeps_second())
    return kept_surface(place_of_child(parent, c) + (second ? tile_texels : 0));
  uvec4 bits = kept_surface(place_of_child(parent, c));
  if (second) {
    bool computed = is_computed(parent.finer), there = finer_has_second(bits, computed);
    ivec2 address = mix(ivec2(0), address_of_child(parent, c), bvec2(there));
    bits = mix(uvec4(0u), finer_surface(address, 1, parent.finer, computed), bvec4(there));
  }
  return bits;
}
vec4 light_in_tile(sap_parent parent, int c, bool second, uint id) {
  int place = place_of_child(parent, c) + (keeps_second() && second ? tile_texels : 0);
  if ((keeps_second() || !second) && !stores_full())
    return vec4(unpackHalf2x16(kept_light(place)),
                unpackHalf2x16(sap_light_ba(kept_surface(place))));
  bool computed = is_computed(parent.finer);
  ivec2 address = mix(ivec2(0), address_of_child(parent, c), bvec2(id != 0u));
  vec4 light = second ? finer_light(address, 1, parent.finer, computed,
                                    finer_surface(address, 1, parent.finer, computed))
                      : finer_light(address, 0, parent.finer, computed, kept_surface(place));
  return mix(vec4(0.0), light, bvec4(id != 0u));
}

#endif
