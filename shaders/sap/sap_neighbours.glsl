// The neighbourhood of a texel on the way up. In the block shape an invocation reads its block, a
// ring around the block and the coarser texels under it once into private arrays; in the texel
// shape the group reads those of its tile into shared memory. The kernel owns these arrays, because
// levels differ in the number of layers.
#ifndef DERMIS_SAP_NEIGHBOURS_GLSL
#define DERMIS_SAP_NEIGHBOURS_GLSL

#include "sap/sap_blocks.glsl"
#include "sap/sap_up.glsl"

// Texel shape: the tile's texels with a ring around them, and the coarser texels under the tile, of
// level 0 and of levels with a border. The second layers follow the first.
const int ring_reach = square_pixels ? 1 : 2;
const int ring_side = 8 + 2 * ring_reach, ring_texels = ring_side * ring_side;
const int coarse_under_pixels = square_pixels ? 6 * 6 : 9 * 9;
const int coarse_under_texels = square_pixels ? 5 * 5 : 9 * 9;

// The kernel that includes this file defines the functions that it uses of the next eight. `layer`:
// 0 or 1.
// Read the images of the level and of the coarser level at an address.
uvec4 read_surface(ivec2 address, int layer);
vec4 read_light(ivec2 address, int layer);
uvec4 read_coarse_surface(ivec2 address, int layer);
uvec4 read_coarse_scattered(ivec2 address, int layer);
// Store texel i of the tile or block with its ring, and of the coarser texels under it.
void keep_texel(int i, uvec4 surface, vec4 light);
void keep_coarse(int i, uvec4 surface, uvec4 scattered);
// Texel shape: return a texel that was stored; its light as halves, exact unless light is stored as
// floats.
uvec4 kept_surface(int i);
uvec2 kept_light(int i);

// The functions of sap_up.glsl.
int tent_reach() { return ring_reach; }
bool branches_on_layers() { return texel_shape; }

// Texels of the ring and coarser texels, of a tile or of a block.
int ring_stride(block_grid grid) {
  return texel_shape ? ring_side : grid.size.x + 2 * ring_reach;
}
// An axis that is not halved has as many coarser texels, and one that is not needed.
ivec2 coarse_size(block_grid grid) {
  ivec2 size = texel_shape ? ivec2(8) : grid.size, halved = size / 2 + 2 - grid.border;
  return square_pixels ? halved : max(halved, size + 1);
}
int coarse_texels(block_grid grid) { return coarse_size(grid).x * coarse_size(grid).y; }
// Indices of texels, without multiplication, because some GPUs multiply 32 bits slowly.
int ring_index(ivec2 at) { return (at.y << 3) + (at.y << (square_pixels ? 1 : 2)) + at.x; }
int coarse_index(block_grid grid, ivec2 at) {
  return square_pixels ? (at.y << 2) + (at.y << (grid.border == 0 ? 1 : 0)) + at.x
                       : (at.y << 3) + at.y + at.x;
}
// Returns i / the coarser texels of a row under a tile, for i below 128.
int coarse_row(block_grid grid, int i) {
  return square_pixels ? i * (grid.border == 0 ? 43 : 52) >> 8 : i * 57 >> 9;
}

bool is_written(texel_block block, int border, ivec2 place, int level) {
  return sap_inside(place - border, level) &&
         tile_written(block.around, (place >> 3) - block.tile + 1);
}
// Texel i of the ring around a tile, as an offset from the tile: the row above, the row below, then
// both columns.
ivec2 ring_offset(int i) {
  if (!square_pixels) { // the two rows and columns on each side
    const int both = 2 * ring_reach;
    int sides = i - both * ring_side;
    ivec2 place = sides < 0 ? ivec2(i % ring_side, i / ring_side)
                            : ivec2(sides % both, ring_reach + sides / both);
    return place + 8 * ivec2(sides >= 0 && place.x >= ring_reach,
                             sides < 0 && place.y >= ring_reach) -
           ring_reach;
  }
  return i < 2 * ring_side ? ivec2((i < ring_side ? i : i - ring_side) - 1, i < ring_side ? -1 : 8)
                           : ivec2((i & 1) == 0 ? -1 : 8, (i >> 1) - ring_side);
}
// Texel shape: texels that an invocation reads, one in the tile and others in the ring.
const int tile_reads = 2 + (ring_texels - 65) / 64;
// Texel shape: reads a texel of the tile and texels of the ring, of one or two layers. With two
// layers, waits for memory once per layer: does not branch around texels that were not written, but
// reads others instead.
void read_ring_of_tile(texel_block block, int border, int level, int layers, bool with_ring) {
  bool in_tile[tile_reads], needed[tile_reads];
  int place[tile_reads];
  ivec2 address[tile_reads];
  uvec4 bits[tile_reads], flags = uvec4(0u);
  vec4 light[tile_reads];
  [[unroll]] for (int k = 0; k < tile_reads; ++k) {
    int i = int(gl_LocalInvocationIndex) + 64 * (k - 1);
    in_tile[k] = k == 0 || i < ring_texels - 64;
    ivec2 offset = k == 0 ? block.first - 8 * block.tile : ring_offset(in_tile[k] ? i : 0);
    ivec2 at = 8 * block.tile + offset - border;
    bool written =
        k == 0 ||
        all(bvec3(in_tile[k], with_ring, tile_written(block.around, (offset >> 3) + 1)));
    needed[k] = all(bvec2(written, k == 0 ? sap_before_end(at, level) : sap_inside(at, level)));
    place[k] = ring_index(offset + ring_reach);
    bits[k] = uvec4(0u);
    light[k] = vec4(0.0);
    address[k] = sap_address(at, level);
    if (layers > 1) {
      address[k] = mix(ivec2(0), address[k], bvec2(needed[k]));
      bits[k] = mix(uvec4(0u), read_surface(address[k], 0), bvec4(needed[k]));
      light[k] = mix(vec4(0.0), read_light(address[k], 0), bvec4(needed[k]));
    } else if (needed[k]) {
      bits[k] = read_surface(address[k], 0);
      light[k] = read_light(address[k], 0);
    }
    flags |= bits[k];
  }
  [[unroll]] for (int k = 0; k < tile_reads; ++k)
    if (in_tile[k])
      keep_texel(place[k], bits[k], light[k]);
  if (layers < 2 || !has_second_near(flags))
    return;
  [[unroll]] for (int k = 0; k < tile_reads; ++k) {
    address[k] = mix(ivec2(0), address[k], bvec2(sap_has_second(bits[k])));
    bits[k] = read_surface(address[k], 1);
    light[k] = read_light(address[k], 1);
  }
  [[unroll]] for (int k = 0; k < tile_reads; ++k)
    if (in_tile[k])
      keep_texel(ring_texels + place[k], bits[k], light[k]);
}
// Reads the texels of the block or tile and, if requested, the ring around them. `layers`: of the
// tile; of a block, only the first layer is read.
void read_ring(texel_block block, block_grid grid, int level, int layers, bool with_ring) {
  if (texel_shape) {
    read_ring_of_tile(block, grid.border, level, layers, with_ring);
    return;
  }
  int width = grid.size.x + 2 * ring_reach, texels = width * (grid.size.y + 2 * ring_reach);
  [[unroll]] for (int i = 0; i < texels; ++i) {
    ivec2 offset = ivec2(i % width, i / width) - ring_reach, place = block.first + offset;
    bool inner =
        all(greaterThanEqual(offset, ivec2(0))) && all(lessThan(offset, grid.size));
    bool needed = (inner || with_ring) && is_written(block, grid.border, place, level);
    ivec2 address = sap_address(place - grid.border, level);
    keep_texel(i, needed ? read_surface(address, 0) : uvec4(0u),
               needed ? read_light(address, 0) : vec4(0.0));
  }
}

// Returns the first of the two nearest coarser texels along each axis. An axis that is not halved
// has only this one.
ivec2 first_corner(ivec2 at, int level) {
  bvec2 halves = greaterThan(step_from_level(level), ivec2(1));
  return mix(at, (at - 1) >> 1, halves);
}
// Reads the coarser texels under the block or tile. They exist if a texel of it exists.
// `block_layers`: of a block; of a tile, all layers are read.
void read_coarser(texel_block block, block_grid grid, int level, int block_layers) {
  ivec2 first = first_corner((texel_shape ? 8 * block.tile : block.first) - grid.border, level);
  const int count = coarse_texels(grid);
  if (texel_shape) {
    int i = int(gl_LocalInvocationIndex);
    [[unroll]] for (int k = 0; k < (count + 63) / 64; ++k, i += 64) {
      int row = coarse_row(grid, i);
      ivec2 at = first + ivec2(i - coarse_index(grid, ivec2(0, row)), row);
      if (i >= count)
        continue;
      uvec4 bits = uvec4(0u), scattered = uvec4(0u);
      ivec2 address = sap_address(at, level + 1);
      if (sap_before_end(at, level + 1)) {
        bits = read_coarse_surface(address, 0);
        scattered = read_coarse_scattered(address, 0);
      }
      keep_coarse(i, bits, scattered);
      if (has_second_corner(bits))
        keep_coarse(count + i, read_coarse_surface(address, 1), read_coarse_scattered(address, 1));
    }
    return;
  }
  [[unroll]] for (int i = 0; i < count; ++i) {
    ivec2 at = first + ivec2(i % coarse_size(grid).x, i / coarse_size(grid).x);
    ivec2 address = sap_address(at, level + 1);
    bool needed = sap_inside(at, level + 1);
    uvec4 bits = needed ? read_coarse_surface(address, 0) : uvec4(0u);
    keep_coarse(i, bits, needed ? read_coarse_scattered(address, 0) : uvec4(0u));
    if (block_layers < 2)
      continue;
    needed = needed && has_second_corner(bits);
    keep_coarse(count + i, needed ? read_coarse_surface(address, 1) : uvec4(0u),
                needed ? read_coarse_scattered(address, 1) : uvec4(0u));
  }
}
// Makes the reads of the group visible to all its invocations.
void finish_reading() {
  if (texel_shape)
    barrier();
}

// Returns the place of texel k of the block.
sap_place place_of(texel_block block, block_grid grid, int k, int level) {
  ivec2 offset = block_offset(grid, k), at = block.first - grid.border, odd, corner;
  int ring;
  if (texel_shape) {
    odd = at & 1;
    ring = ring_index(block.first - 8 * block.tile + ring_reach);
    corner = first_corner(at, level) - first_corner(8 * block.tile - grid.border, level);
    return sap_place(at, odd, ring, coarse_index(grid, corner), 0, 0, 0);
  }
  // The first texel of a block is even; `offset` does not depend on the invocation.
  odd = (offset + grid.border) & 1;
  ring = (offset.y + ring_reach) * ring_stride(grid) + offset.x + ring_reach;
  corner = first_corner(offset + grid.border, level) - first_corner(ivec2(grid.border), level);
  return sap_place(at + offset, odd, ring, corner.y * coarse_size(grid).x + corner.x, 0, 0, 0);
}
// Return the indices of a neighbour, and of corner n.
int ring_place(block_grid grid, sap_place place, ivec2 step) {
  return place.ring + ring_stride(grid) * step.y + step.x;
}
int corner_place(block_grid grid, sap_place place, int n) {
  return place.corner + n / 2 * coarse_size(grid).x + n % 2;
}

// Texel shape: returns the light of a neighbour.
vec4 light_in_tile(block_grid grid, sap_place place, int level, ivec2 step, int layer) {
  int i = layer * ring_texels + ring_place(grid, place, step);
  if (!stores_full())
    return vec4(unpackHalf2x16(kept_light(i).x), unpackHalf2x16(kept_light(i).y));
  vec4 light = vec4(0.0);
  if (step == ivec2(0) || kept_surface(i).w != 0u)
    light = read_light(sap_address(place.at + step, level), layer);
  return light;
}

#endif
