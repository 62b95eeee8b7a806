// The neighbourhood of a texel on the way up. In the block shape an invocation reads its block, a
// ring around the block and the coarser texels under it once into private arrays; in the texel
// shape the group reads those of its tile into shared memory.
// Include after bindings with `light`, `surface`, `coarse_surface`, `coarse_scattered` and
// `level_tiles`, and after `block_width`, `block_height`, `coarse_width`, `coarse_height` (coarser
// texels under a block), `border` (1 if the level has a border, so that the first texel of a tile
// is odd; else 0) and the macros of sap_up.glsl.
// - Second layers need `second_light`, `second_surface`, `second_coarse_surface` and
//   `second_coarse_scattered`. With two own layers a block is read with one layer, and texels that
//   involve a second layer are read one by one.
#ifndef DERMIS_SAP_NEIGHBOURS_GLSL
#define DERMIS_SAP_NEIGHBOURS_GLSL

// The texel that is computed.
struct sap_place {
  ivec2 at;   // texel of its level
  ivec2 odd;  // parity of its position
  int ring;   // texel shape: its index in the tile's ring
  int corner; // texel shape: index of its first corner in the tile's coarser texels
};

// Texels to each side that the tent of a level reads.
const int tent_reach = square_pixels ? 1 : 2;
const int near_side = 2 * tent_reach + 1, near_texels = near_side * near_side;
const int corner_texels = 4, near_centre = near_texels / 2;
ivec2 near_step(int n) { return ivec2(n % near_side - tent_reach, n / near_side - tent_reach); }

// Texel shape: the tile's texels with a ring around them, and the coarser texels under the tile.
// The second layers follow the first.
const int ring_side = 8 + 2 * tent_reach, ring_texels = ring_side * ring_side;
// An axis that is not halved has as many coarser texels, and one that is not needed.
const int coarse_side = square_pixels ? 6 - border : 9;
const int tile_coarse_texels = coarse_side * coarse_side;
// Indices of texels, without multiplication, because some GPUs multiply 32 bits slowly.
int ring_index(ivec2 at) { return (at.y << 3) + (at.y << (square_pixels ? 1 : 2)) + at.x; }
int coarse_index(ivec2 at) {
  return square_pixels ? (at.y << 2) + (at.y << (border == 0 ? 1 : 0)) + at.x
                       : (at.y << 3) + at.y + at.x;
}
// Returns i / coarse_side, for i below 128.
int coarse_row(int i) { return square_pixels ? i * (border == 0 ? 43 : 52) >> 8 : i * 57 >> 9; }
#ifndef SAP_NO_RING
shared uvec4 tile_surface[texel_shape ? SAP_OWN_LAYERS * ring_texels : 1];
// halves, exact unless `storage` is full
shared uvec2 tile_light[texel_shape ? SAP_OWN_LAYERS * ring_texels : 1];
#endif
shared uvec4 tile_coarse_surface[texel_shape ? SAP_COARSE_LAYERS * tile_coarse_texels : 1];
shared uvec4 tile_coarse_scattered[texel_shape ? SAP_COARSE_LAYERS * tile_coarse_texels : 1];

// Block shape: the neighbourhood of the current texel. The second layer follows the first.
uvec4 corner_surface[SAP_COARSE_LAYERS * corner_texels];
uvec4 corner_scattered[SAP_COARSE_LAYERS * corner_texels];
#ifndef SAP_NO_RING
uvec4 near_surface[SAP_OWN_LAYERS * near_texels];
vec4 near_light[SAP_OWN_LAYERS * near_texels];
#endif

// Coarser texels of a block. Their second layers follow, unless the level itself has two layers.
const int block_coarse_layers = SAP_OWN_LAYERS > 1 ? 1 : SAP_COARSE_LAYERS;
const int coarse_columns = square_pixels ? coarse_width : max(coarse_width, block_width + 1);
const int coarse_rows = square_pixels ? coarse_height : max(coarse_height, block_height + 1);
const int coarse_texels = coarse_columns * coarse_rows;
// Returns the first of the two nearest coarser texels along each axis. An axis that is not halved
// has only this one.
ivec2 first_corner(ivec2 at, int level) {
  bvec2 halves = greaterThan(step_from_level(level), ivec2(1));
  return mix(at, (at - 1) >> 1, halves);
}
uvec4 coarse_surface[block_coarse_layers * coarse_texels];
uvec4 coarse_scattered[block_coarse_layers * coarse_texels];

// Returns whether the second layer of a texel of the coarser level can be read.
bool has_second_corner(uvec4 bits) {
#if SAP_COARSE_LAYERS > 1
  return sap_has_second(bits) && has_second_coarse_surface() && has_second_coarse_scattered();
#else
  return false;
#endif
}

#if SAP_OWN_LAYERS > 1
// Returns whether the second layer of a texel of the level can be read.
bool has_second_near(uvec4 bits) {
  return sap_has_second(bits) && has_second_light() && has_second_surface();
}
#endif

#ifndef SAP_NO_RING
const int block_ring_width = block_width + 2 * tent_reach,
          block_ring_height = block_height + 2 * tent_reach;
uvec4 ring_surface[block_ring_width * block_ring_height];
vec4 ring_light[block_ring_width * block_ring_height];

bool is_written(texel_block block, ivec2 place, int level) {
  return sap_inside(place - border, level) &&
         tile_written(block.around, (place >> 3) - block.tile + 1);
}
// Texel i of the ring around a tile, as an offset from the tile: the row above, the row below, then
// both columns.
ivec2 ring_offset(int i) {
  if (!square_pixels) { // the two rows and columns on each side
    const int both = 2 * tent_reach;
    int sides = i - both * ring_side;
    ivec2 place = sides < 0 ? ivec2(i % ring_side, i / ring_side)
                            : ivec2(sides % both, tent_reach + sides / both);
    return place + 8 * ivec2(sides >= 0 && place.x >= tent_reach,
                             sides < 0 && place.y >= tent_reach) -
           tent_reach;
  }
  return i < 2 * ring_side ? ivec2((i < ring_side ? i : i - ring_side) - 1, i < ring_side ? -1 : 8)
                           : ivec2((i & 1) == 0 ? -1 : 8, (i >> 1) - ring_side);
}
// Texel shape: texels that an invocation reads, one in the tile and others in the ring.
const int tile_reads = 2 + (ring_texels - 65) / 64;
// Texel shape: reads a texel of the tile and texels of the ring. With two layers, waits for memory
// once per layer: does not branch around texels that were not written, but reads others instead.
void read_ring_of_tile(texel_block block, int level, bool with_ring) {
  bool in_tile[tile_reads], needed[tile_reads];
  int place[tile_reads];
  ivec2 address[tile_reads];
  uvec4 bits[tile_reads];
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
    place[k] = ring_index(offset + tent_reach);
    bits[k] = uvec4(0u);
    light[k] = vec4(0.0);
    address[k] = sap_address(at, level);
#if SAP_OWN_LAYERS > 1
    address[k] = mix(ivec2(0), address[k], bvec2(needed[k]));
    bits[k] = texelFetch(surface_image, address[k], 0);
    light[k] = texelFetch(light_image, address[k], 0);
    bits[k] = mix(uvec4(0u), bits[k], bvec4(needed[k]));
    light[k] = mix(vec4(0.0), light[k], bvec4(needed[k]));
#else
    if (needed[k]) {
      bits[k] = texelFetch(surface_image, address[k], 0);
      light[k] = texelFetch(light_image, address[k], 0);
    }
#endif
  }
  [[unroll]] for (int k = 0; k < tile_reads; ++k)
    if (in_tile[k]) {
      tile_surface[place[k]] = bits[k];
      tile_light[place[k]] = uvec2(packHalf2x16(light[k].rg), sap_light_ba(bits[k]));
    }
#if SAP_OWN_LAYERS > 1
  uvec4 flags = uvec4(0u);
  [[unroll]] for (int k = 0; k < tile_reads; ++k)
    flags |= bits[k];
  if (has_second_near(flags)) {
    [[unroll]] for (int k = 0; k < tile_reads; ++k) {
      address[k] = mix(ivec2(0), address[k], bvec2(sap_has_second(bits[k])));
      bits[k] = texelFetch(second_surface_image, address[k], 0);
      light[k] = texelFetch(second_light_image, address[k], 0);
    }
    [[unroll]] for (int k = 0; k < tile_reads; ++k)
      if (in_tile[k]) {
        tile_surface[ring_texels + place[k]] = bits[k];
        tile_light[ring_texels + place[k]] =
            uvec2(packHalf2x16(light[k].rg), sap_light_ba(bits[k]));
      }
  }
#endif
}
// Reads the texels of the block or tile and, if requested, the ring around them.
void read_ring(texel_block block, int level, bool with_ring) {
  if (texel_shape) {
    read_ring_of_tile(block, level, with_ring);
  } else {
    [[unroll]] for (int i = 0; i < block_ring_width * block_ring_height; ++i) {
      int x = i % block_ring_width - tent_reach, y = i / block_ring_width - tent_reach;
      bool inner = x >= 0 && y >= 0 && x < block_width && y < block_height;
      ivec2 place = block.first + ivec2(x, y);
      bool needed = (inner || with_ring) && is_written(block, place, level);
      ring_surface[i] =
          needed ? texelFetch(surface_image, sap_address(place - border, level), 0) : uvec4(0u);
      ring_light[i] = sap_light(
          ring_surface[i],
          needed ? texelFetch(light_image, sap_address(place - border, level), 0) : vec4(0.0),
          settings.storage == STORAGE_FULL);
    }
  }
}
#endif

// Reads the coarser texels under the block or tile. They exist if a texel of it exists.
void read_coarser(texel_block block, int level) {
  ivec2 first = first_corner((texel_shape ? 8 * block.tile : block.first) - border, level);
  if (texel_shape) {
    int i = int(gl_LocalInvocationIndex);
    [[unroll]] for (int k = 0; k < (tile_coarse_texels + 63) / 64; ++k, i += 64) {
      int row = coarse_row(i);
      ivec2 at = first + ivec2(i - coarse_index(ivec2(0, row)), row);
      if (i >= tile_coarse_texels)
        continue;
      uvec4 bits = uvec4(0u), scattered = uvec4(0u);
      ivec2 address = sap_address(at, level + 1);
      if (sap_before_end(at, level + 1)) {
        bits = texelFetch(coarse_surface_image, address, 0);
        scattered = texelFetch(coarse_scattered_image, address, 0);
      }
      tile_coarse_surface[i] = bits;
      tile_coarse_scattered[i] = scattered;
#if SAP_COARSE_LAYERS > 1
      if (has_second_corner(bits)) {
        tile_coarse_surface[tile_coarse_texels + i] =
            texelFetch(second_coarse_surface_image, address, 0);
        tile_coarse_scattered[tile_coarse_texels + i] =
            texelFetch(second_coarse_scattered_image, address, 0);
      }
#endif
    }
  } else {
    [[unroll]] for (int i = 0; i < coarse_texels; ++i) {
      ivec2 at = first + ivec2(i % coarse_columns, i / coarse_columns);
      bool needed = sap_inside(at, level + 1);
      coarse_surface[i] =
          needed ? texelFetch(coarse_surface_image, sap_address(at, level + 1), 0) : uvec4(0u);
      coarse_scattered[i] =
          needed ? texelFetch(coarse_scattered_image, sap_address(at, level + 1), 0) : uvec4(0u);
#if SAP_COARSE_LAYERS > 1 && SAP_OWN_LAYERS == 1
      needed = needed && has_second_corner(coarse_surface[i]);
      coarse_surface[coarse_texels + i] =
          needed ? texelFetch(second_coarse_surface_image, sap_address(at, level + 1), 0)
                 : uvec4(0u);
      coarse_scattered[coarse_texels + i] =
          needed ? texelFetch(second_coarse_scattered_image, sap_address(at, level + 1), 0)
                 : uvec4(0u);
#endif
    }
  }
}
// Makes the reads of the group visible to all its invocations.
void finish_reading() {
  if (texel_shape)
    barrier();
}

sap_place place_of(texel_block block, int k, int level) {
  ivec2 offset = block_offset(k);
  if (texel_shape) {
    ivec2 local = block.first - 8 * block.tile, at = block.first - border;
    ivec2 corner = first_corner(at, level) - first_corner(8 * block.tile - border, level);
    return sap_place(at, at & 1, ring_index(local + tent_reach), coarse_index(corner));
  }
  return sap_place(block.first - border + offset, (offset + border) & 1, 0, 0);
}

#ifndef SAP_NO_RING
// Selects the neighbourhood of texel k of the block. Returns the union of the words with flags.
uint take_near(int k) {
  uint bits = 0u;
  if (!texel_shape) {
    [[unroll]] for (int n = 0; n < near_texels; ++n) {
      ivec2 at = block_offset(k) + tent_reach + near_step(n);
      int i = at.y * block_ring_width + at.x;
      near_surface[n] = ring_surface[i];
      near_light[n] = ring_light[i];
      bits |= ring_surface[i].x;
    }
  }
  return bits;
}
#endif
// Selects the coarser texels under texel k of the block. Returns the union of the words with flags.
uint take_corners(int k, int level) {
  uint bits = 0u;
  if (!texel_shape) {
    ivec2 at = block_offset(k) + border; // relative to an even texel
    ivec2 first = first_corner(at, level) - first_corner(ivec2(border), level);
    [[unroll]] for (int n = 0; n < block_coarse_layers * corner_texels; ++n) {
      int row = first.y + n % corner_texels / 2;
      int i = n / corner_texels * coarse_texels + row * coarse_columns + first.x + n % 2;
      corner_surface[n] = coarse_surface[i];
      corner_scattered[n] = coarse_scattered[i];
      bits |= coarse_surface[i].x;
    }
  }
  return bits;
}

#if SAP_OWN_LAYERS > 1
// Block shape: reads both layers of a texel and, if requested, of its neighbours.
void read_near(texel_block block, ivec2 place, int level, bool with_ring) {
  [[unroll]] for (int n = 0; n < near_texels; ++n) {
    ivec2 at = place - border + near_step(n);
    bool needed = (n == near_centre || with_ring) && is_written(block, place + near_step(n), level);
    near_surface[n] = needed ? texelFetch(surface_image, sap_address(at, level), 0) : uvec4(0u);
    bool full = settings.storage == STORAGE_FULL;
    near_light[n] =
        sap_light(near_surface[n],
                  needed ? texelFetch(light_image, sap_address(at, level), 0) : vec4(0.0), full);
    needed = needed && has_second_near(near_surface[n]);
    near_surface[near_texels + n] =
        needed ? texelFetch(second_surface_image, sap_address(at, level), 0) : uvec4(0u);
    near_light[near_texels + n] = sap_light(
        near_surface[near_texels + n],
        needed ? texelFetch(second_light_image, sap_address(at, level), 0) : vec4(0.0), full);
  }
}
// Block shape: reads both layers of the coarser texels under the texel.
void read_corners(ivec2 place, int level, bool there) {
  [[unroll]] for (int n = 0; n < corner_texels; ++n) {
    ivec2 at = first_corner(place, level) + ivec2(n % 2, n / 2);
    bool needed = there && sap_inside(at, level + 1);
    corner_surface[n] =
        needed ? texelFetch(coarse_surface_image, sap_address(at, level + 1), 0) : uvec4(0u);
    corner_scattered[n] =
        needed ? texelFetch(coarse_scattered_image, sap_address(at, level + 1), 0) : uvec4(0u);
    needed = needed && has_second_corner(corner_surface[n]);
    int second = corner_texels + n;
    corner_surface[second] =
        needed ? texelFetch(second_coarse_surface_image, sap_address(at, level + 1), 0) : uvec4(0u);
    corner_scattered[second] =
        needed ? texelFetch(second_coarse_scattered_image, sap_address(at, level + 1), 0)
               : uvec4(0u);
  }
}
#endif

// Neighbour n of the texel (0 to 8, row by row): bits of its surface, and its light.
#ifndef SAP_NO_RING
int ring_place(sap_place place, int n) {
  return place.ring + ring_side * near_step(n).y + near_step(n).x;
}
uvec4 near_bits(sap_place place, int n) {
  return texel_shape ? tile_surface[ring_place(place, n)] : near_surface[n];
}
// Texel shape: the light of a layer of neighbour n.
vec4 light_in_tile(sap_place place, int level, int n, int layer) {
  int i = layer * ring_texels + ring_place(place, n);
  if (settings.storage != STORAGE_FULL)
    return vec4(unpackHalf2x16(tile_light[i].x), unpackHalf2x16(tile_light[i].y));
  ivec2 address = sap_address(place.at + near_step(n), level);
  vec4 light = vec4(0.0);
  if (n == near_centre || tile_surface[i].w != 0u) {
#if SAP_OWN_LAYERS > 1
    if (layer > 0)
      return texelFetch(second_light_image, address, 0);
#endif
    light = texelFetch(light_image, address, 0);
  }
  return light;
}
vec4 light_near(sap_place place, int level, int n) {
  return texel_shape ? light_in_tile(place, level, n, 0) : near_light[n];
}
#if SAP_OWN_LAYERS > 1
uvec4 second_near_bits(sap_place place, int level, int n) {
  return texel_shape ? tile_surface[ring_texels + ring_place(place, n)]
                     : near_surface[near_texels + n];
}
vec4 second_light_near(sap_place place, int level, int n) {
  return texel_shape ? light_in_tile(place, level, n, 1) : near_light[near_texels + n];
}
#endif
#endif

// Corner n of the texel (0 to 3, row by row): bits of its surface, and its values.
int corner_place(sap_place place, int n) { return place.corner + n / 2 * coarse_side + n % 2; }
uvec4 corner_bits(sap_place place, int n) {
  return texel_shape ? tile_coarse_surface[corner_place(place, n)] : corner_surface[n];
}
uvec4 scattered_at_corner(sap_place place, int n) {
  return texel_shape ? tile_coarse_scattered[corner_place(place, n)] : corner_scattered[n];
}
#if SAP_COARSE_LAYERS > 1
uvec4 second_corner_bits(sap_place place, int level, int n) {
  return texel_shape ? tile_coarse_surface[tile_coarse_texels + corner_place(place, n)]
                     : corner_surface[corner_texels + n];
}
uvec4 second_scattered_at_corner(sap_place place, int level, int n) {
  return texel_shape ? tile_coarse_scattered[tile_coarse_texels + corner_place(place, n)]
                     : corner_scattered[corner_texels + n];
}
#endif

#endif
