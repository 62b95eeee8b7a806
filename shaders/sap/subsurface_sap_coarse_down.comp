#version 460
// Computes all levels from `level` to the coarsest in one dispatch. A group computes a tile of the
// first level. The group that completes the last child of a tile of the next level goes on with
// that tile, so no group waits for another one.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "sap/subsurface_sap_coarse_down.bindings.glsl"
#include "common/environment.glsl"
#include "common/half.glsl"
#define DERMIS_ONE_SHAPE
#define SAP_SECOND
#define SAP_SECOND_IN_TILE
#define SAP_WINDOW
#define SAP_ROW_SUMS
#define DERMIS_WIDE_GROUP
#include "sap/sap.glsl"
#include "sap/sap_levels.glsl"

ivec3 written_place(ivec2 address, int level, int content) {
  return place_in_levels(address, level - settings.level, content);
}
// Sources of the children: images of the finer level, or levels of this dispatch.
bool is_computed(int finer) { return finer >= settings.level; }
uvec4 finer_surface(ivec2 address, int finer, bool computed) {
  if (computed)
    return imageLoad(levels_image, written_place(address, finer, surface_in_levels));
  return texelFetch(surface_image, address, 0);
}
vec4 finer_light(ivec2 address, int finer, bool computed, uvec4 bits) {
  if (computed)
    return light_from_bits(imageLoad(levels_image, written_place(address, finer, light_in_levels)));
  return sap_light(bits, texelFetch(light_image, address, 0), settings.storage == STORAGE_FULL);
}
bool finer_has_layers() { return true; }
bool finer_has_second(uvec4 bits, bool computed) {
  return sap_has_second(bits) && (computed || has_second_surface() && has_second_light());
}
uvec4 second_finer_surface(ivec2 address, int finer, bool computed) {
  if (computed)
    return imageLoad(levels_image, written_place(address, finer, surface_in_levels + 1));
  return texelFetch(second_surface_image, address, 0);
}
vec4 second_finer_light(ivec2 address, int finer, bool computed, uvec4 bits) {
  if (computed)
    return light_from_bits(
        imageLoad(levels_image, written_place(address, finer, light_in_levels + 1)));
  return sap_light(bits, texelFetch(second_light_image, address, 0),
                   settings.storage == STORAGE_FULL);
}
#include "sap/sap_down.glsl"

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
#include "sap/sap_down_layers.glsl"
#include "sap/sap_layered_texels.glsl"
#include "sap/sap_wide_tile.glsl"

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

// Computes the texels of a tile whose children are in shared memory.
void compute_tile(uvec2 entry, int level) {
  int rows = min(sap_level_size(level).y + 2 - 8 * tile_of_entry(entry).y, 8);
  begin_layered_texels();
  [[dont_unroll]] for (int part = int(gl_LocalInvocationIndex); part < 8 * rows;
                       part += int(group_lanes)) {
    sap_parent parent = take_parent(block_of_entry(entry, part), 0, level - 1);
    if (sap_inside(parent.at, level)) {
      sap_layer layer = reduce(parent, 1, no_texel);
      if (parent.two || layer.remains)
        collect_layered_texel(part);
      else
        store_layer(parent, level, false, layer);
    }
  }
  barrier();
  [[dont_unroll]] for (uint i = gl_LocalInvocationIndex; i < layered_count; i += group_lanes) {
    texel_block block = block_of_entry(entry, int(layered_texels[i]));
    compute_parent(take_parent(block, 0, level - 1), level);
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
    texel_block block = block_of_entry(next.xy, 0);
    if (is_computed(level - 1))
      read_tile(block, level - 1, true);
    else
      read_tile(block, level - 1, false);
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
