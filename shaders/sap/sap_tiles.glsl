// Iteration over the listed 8x8 tiles of a level of the surface-aware pyramid. Include after
// bindings with `level_tiles` and the setting `storage`, and after `block_width` and
// `block_height`.
// Kernels have two shapes:
// - Texel shape, for GPUs: one texel per invocation and one tile per group. Texels that the group
//   shares are in shared memory.
// - Block shape, for drivers on the CPU: one block of texels per invocation. A block reads the
//   texels that its own texels share once, without shared memory, which is slow there.
#ifndef DERMIS_SAP_TILES_GLSL
#define DERMIS_SAP_TILES_GLSL

#include "common/half.glsl"
#include "options.glsl"
#include "sap/sap_lists.glsl"
#ifdef DERMIS_ONE_SHAPE
#include "sap/one_shape.glsl"
#else
#include "common/shape.glsl"
layout(local_size_x = 64, local_size_y = 1, local_size_z = 1) in;
#endif

const uint group_lanes = gl_WorkGroupSize.x;

const int blocks_across = 8 / block_width;
const int blocks_per_tile = blocks_across * (8 / block_height);
const int invocations_per_tile = texel_shape ? 64 : blocks_per_tile;
const int block_texels = texel_shape ? 1 : block_width * block_height;

struct texel_block {
  ivec2 first;   // address of the first texel, counted from the corner of the level's border
  ivec2 tile;
  bool copy_only; // level 0: no pixel of the tile scatters further than itself
  // Mask of written tiles among the 3x3 tiles of the finer level that the own tile reduces.
  uint children;
  uint around;   // mask of written tiles among the 3x3 tiles around
};

ivec2 tile_of_entry(uvec2 entry) { return ivec2(entry.x & 0x7fffu, (entry.x >> 15) & 0x7fffu); }

// Returns the block of invocation `part` of a listed tile.
texel_block block_of_entry(uvec2 entry, int part) {
  texel_block block;
  block.tile = tile_of_entry(entry);
  block.first = 8 * block.tile + (texel_shape ? ivec2(part & 7, part >> 3)
                                              : ivec2(part % blocks_across * block_width,
                                                      part / blocks_across * block_height));
  block.copy_only = (entry.x & tile_copy_bit) != 0u;
  block.children = entry.y & 0x1ffu;
  block.around = entry.y >> 9;
  return block;
}

uint dispatched_group() { return gl_WorkGroupID.y * tile_groups_per_row + gl_WorkGroupID.x; }

// Returns false beyond the end of the list. In the texel shape, all invocations of a group have the
// same tile.
bool listed_block(int level, out texel_block block) {
  // In the texel shape the index is uniform, so that the entry is read once for the group.
  uint index = texel_shape ? dispatched_group()
                           : dispatched_group() * uint(64 / invocations_per_tile) +
                                 gl_LocalInvocationIndex / uint(invocations_per_tile);
  uvec2 list = level_tiles_data[level];
  block = texel_block(ivec2(0), ivec2(0), false, 0u, 0u);
  if (index >= list.y)
    return false;
  block = block_of_entry(level_tiles_data[list.x + index],
                         int(gl_LocalInvocationIndex) & (invocations_per_tile - 1));
  return true;
}

// Rounds light as the setting `storage` says.
vec4 sap_stored(vec4 light) {
  return settings.storage == STORAGE_FULL ? light : round_to_half(light);
}

// Returns the position of texel k in the block.
ivec2 block_offset(int k) { return ivec2(k % block_width, k / block_width); }

// Returns whether a tile was written, by its offset of 0 to 2 from the first of the mask's 3x3
// tiles.
bool tile_written(uint mask, ivec2 offset) {
  return (mask >> uint(3 * offset.y + offset.x) & 1u) != 0u;
}

#endif
