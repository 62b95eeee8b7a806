#version 460
// Computes all levels from `level` to the coarsest in one dispatch. A group computes a tile of the
// first level. The group that completes the last child of a tile of the next level goes on with
// that tile, so no group waits for another one.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "sap/subsurface_sap_coarse_down.bindings.glsl"
#include "sap/sap_levels.glsl"
#include "sap/sap_tile_children.glsl"
#include "sap/wide_group.glsl"

layout(constant_id = 0) const bool texel_lists = true; // lists are divided as for the texel shape
const uint group_lanes = gl_WorkGroupSize.x;

bool stores_full() { return settings.storage == STORAGE_FULL; }

// The children of the group's tile; their second layers follow.
shared uvec4 tile_surface[2 * tile_texels];
shared uint tile_light[2 * tile_texels];
bool keeps_second() { return true; }
void keep_child(int place, uvec4 surface, uint light) {
  tile_surface[place] = surface;
  tile_light[place] = light;
}
uvec4 kept_surface(int place) { return tile_surface[place]; }
uint kept_light(int place) { return tile_light[place]; }
// Comes after the first use of `tile_surface`, which is therefore the first variable in shared
// memory: GPUs read 16 aligned bytes at once.
#include "sap/sap_wide_tile.glsl"

ivec3 written_place(ivec2 address, int level, int content) {
  return place_in_levels(address, level - settings.level, content);
}
// Sources of the children: images of the finer level, or levels of this dispatch.
bool is_computed(int finer) { return finer >= settings.level; }
uvec4 finer_surface(ivec2 address, int layer, int finer, bool computed) {
  if (computed)
    return imageLoad(levels_image, written_place(address, finer, surface_in_levels + layer));
  return layer == 0 ? texelFetch(surface_image, address, 0)
                    : texelFetch(second_surface_image, address, 0);
}
vec4 finer_light(ivec2 address, int layer, int finer, bool computed, uvec4 bits) {
  if (computed)
    return light_from_bits(
        imageLoad(levels_image, written_place(address, finer, light_in_levels + layer)));
  return sap_stored_light(bits, layer == 0 ? texelFetch(light_image, address, 0)
                                           : texelFetch(second_light_image, address, 0));
}
bool finer_has_layers() { return true; }
bool finer_has_second(uvec4 bits, bool computed) {
  return sap_has_second(bits) && (computed || has_second_surface() && has_second_light());
}

int children_across() { return 4; }
bool shares_children() { return true; }
sap_texel child_of(sap_parent parent, int c, bool second) {
  return sap_unpack(surface_in_tile(parent, c, second));
}
vec4 light_of(sap_parent parent, int c, bool second, uint id) {
  return light_in_tile(parent, c, second, id);
}

bool writes_second() { return true; }
void store_layer(sap_parent parent, int level, bool second, sap_layer layer) {
  ivec2 address = sap_address(parent.at, level);
  int offset = second ? 1 : 0;
  imageStore(levels_image, written_place(address, level, surface_in_levels + offset), layer.bits);
  imageStore(levels_image, written_place(address, level, light_in_levels + offset),
             light_to_bits(layer.light));
  if (has_level_light() && !second && level == settings.level)
    imageStore(level_light_image, address, layer.light);
}

// Tiles that the group still has to compute: entry in the list, and level. The children of at most
// 2x2 tiles of a level include a given tile.
shared uvec3 pending[4 * sap_levels];
shared uint pending_count;
shared uvec2 lists[sap_levels]; // index of the first entry of each level, and number of entries

// Counts a computed tile in the tiles of the next level of which it is a child. Adds those to
// `pending` whose last child it is. All its texels must be written.
void count_in_parents(ivec2 tile, int level) {
  int parents = level + 1;
  uvec2 list = lists[parents];
  uint first = 0u; // counter of the first tile of the list
  for (int l = settings.level + 1; l < parents; ++l)
    first += lists[l].y;
  [[dont_unroll]] for (uint i = gl_LocalInvocationIndex; i < list.y; i += group_lanes) {
    uvec2 entry = level_tiles_data[list.x + i];
    ivec2 away = abs(tile - 2 * tile_of_entry(entry));
    if (max(away.x, away.y) > 1)
      continue;
    uint computed = atomicAdd(computed_children_data[first + i], 1u) + 1u;
    if (computed == uint(bitCount(entry.y & 0x1ffu)))
      pending[atomicAdd(pending_count, 1u)] = uvec3(entry, parents);
  }
}

// Texels of a tile that involve second layers. Drivers on the CPU execute the code for second
// layers in all invocations of a vector if one needs it, so that these texels are computed
// together, after the others.
shared uint layered_texels[wide_group ? 1 : 64];
shared uint layered_count;

// Computes the texels of a tile whose children are in shared memory.
void compute_tile(uvec2 entry, int level) {
  int rows = min(sap_level_size(level).y + 2 - 8 * tile_of_entry(entry).y, 8);
  barrier(); // the texels of the last tile are computed
  if (gl_LocalInvocationIndex == 0u)
    layered_count = 0u;
  barrier();
  [[dont_unroll]] for (int part = int(gl_LocalInvocationIndex); part < 8 * rows;
                       part += int(group_lanes)) {
    sap_parent parent = parent_in_tile(texel_of_entry(entry, part), level - 1);
    if (sap_inside(parent.at, level)) {
      sap_layer layer = reduce(parent, 1, no_texel);
      if (parent.two || layer.remains)
        layered_texels[atomicAdd(layered_count, 1u)] = uint(part);
      else
        store_layer(parent, level, false, layer);
    }
  }
  barrier();
  [[dont_unroll]] for (uint i = gl_LocalInvocationIndex; i < layered_count; i += group_lanes) {
    texel_block texel = texel_of_entry(entry, int(layered_texels[i]));
    compute_parent(parent_in_tile(texel, level - 1), level);
  }
}

// Computes the pending tiles and all tiles that these complete.
void compute_pending() {
  [[dont_unroll]] while (pending_count > 0u) {
    uvec3 next = pending[pending_count - 1u];
    barrier();
    if (gl_LocalInvocationIndex == 0u)
      --pending_count;
    int level = int(next.z);
    texel_block block = texel_of_entry(next.xy, 0);
    if (is_computed(level - 1))
      read_tile(block, level - 1, true, int(group_lanes));
    else
      read_tile(block, level - 1, false, int(group_lanes));
    if (wide_group)
      compute_tile_together(next.xy, level);
    else
      compute_tile(next.xy, level);
    memoryBarrier(); // the texels are available before the tile counts
    barrier();
    if (level + 1 < sap_levels)
      count_in_parents(block.tile, level);
    memoryBarrier(); // texels of other groups are visible after their tiles counted
    barrier();
  }
}

void main() {
  uint tiles = texel_lists ? 1u : sap_tiles_per_group;
  [[dont_unroll]] for (uint l = gl_LocalInvocationIndex; l < uint(sap_levels); l += group_lanes)
    lists[l] = level_tiles_data[l];
  uvec2 list = level_tiles_data[settings.level];
  for (uint k = 0u; k < tiles; ++k) {
    uint index = dispatched_group() * tiles + k;
    if (index >= list.y)
      return;
    barrier(); // all invocations found that nothing is pending
    if (gl_LocalInvocationIndex == 0u) {
      pending[0] = uvec3(level_tiles_data[list.x + index], settings.level);
      pending_count = 1u;
    }
    barrier();
    compute_pending();
  }
}
