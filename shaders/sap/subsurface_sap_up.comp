#version 460
// Computes the next finer level with two layers per texel: blends its own light with the values of
// the coarser level by the profile's fractions. The block shape first computes one layer of all
// texels. Then it recomputes, one by one and from both layers, the texels that have a second layer
// themselves, next to them or in the coarser level.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "sap/subsurface_sap_up.bindings.glsl"
#include "sap/sap_climb.glsl"
#include "sap/sap_neighbours.glsl"
#include "sap/sap_rounds.glsl"

bool stores_full() { return settings.storage == STORAGE_FULL; }
uvec2 level_tiles_at(uint index) { return level_tiles_data[index]; }

uvec4 read_surface(ivec2 address, int layer) {
  return layer == 0 ? texelFetch(surface_image, address, 0)
                    : texelFetch(second_surface_image, address, 0);
}
vec4 read_light(ivec2 address, int layer) {
  return layer == 0 ? texelFetch(light_image, address, 0)
                    : texelFetch(second_light_image, address, 0);
}
uvec4 read_coarse_surface(ivec2 address, int layer) {
  return layer == 0 ? texelFetch(coarse_surface_image, address, 0)
                    : texelFetch(second_coarse_surface_image, address, 0);
}
uvec4 read_coarse_scattered(ivec2 address, int layer) {
  return layer == 0 ? texelFetch(coarse_scattered_image, address, 0)
                    : texelFetch(second_coarse_scattered_image, address, 0);
}
bool has_second_near(uvec4 bits) {
  return sap_has_second(bits) && has_second_light() && has_second_surface();
}
bool has_second_corner(uvec4 bits) {
  return sap_has_second(bits) && has_second_coarse_surface() && has_second_coarse_scattered();
}

// Texel shape: both layers of the texels of the group.
shared uvec4 tile_surface[texel_shape ? 2 * ring_texels : 1];
shared uvec2 tile_light[texel_shape ? 2 * ring_texels : 1];
shared uvec4 tile_coarse_surface[texel_shape ? 2 * coarse_under_texels : 1];
shared uvec4 tile_coarse_scattered[texel_shape ? 2 * coarse_under_texels : 1];
// Block shape: the first layer of the texels of the block.
const int block_ring_side = 2 + 2 * ring_reach, block_coarse = square_pixels ? 2 * 2 : 3 * 3;
uvec4 ring_surface[block_ring_side * block_ring_side];
vec4 ring_light[block_ring_side * block_ring_side];
uvec4 coarse_surface[block_coarse], coarse_scattered[block_coarse];
// Block shape: the neighbourhood of the current texel; the second layer follows the first.
const int near_side = 2 * ring_reach + 1, near_texels = near_side * near_side, corner_texels = 4;
uvec4 texel_surface[2 * near_texels];
vec4 texel_light[2 * near_texels];
uvec4 texel_corners[2 * corner_texels], texel_scattered[2 * corner_texels];

void keep_texel(int i, uvec4 surface, vec4 light) {
  if (texel_shape) {
    tile_surface[i] = surface;
    tile_light[i] = uvec2(packHalf2x16(light.rg), sap_light_ba(surface));
  } else {
    ring_surface[i] = surface;
    ring_light[i] = sap_stored_light(surface, light);
  }
}
void keep_coarse(int i, uvec4 surface, uvec4 scattered) {
  if (texel_shape) {
    tile_coarse_surface[i] = surface;
    tile_coarse_scattered[i] = scattered;
  } else {
    coarse_surface[i] = surface;
    coarse_scattered[i] = scattered;
  }
}
uvec4 kept_surface(int i) { return tile_surface[i]; }
uvec2 kept_light(int i) { return tile_light[i]; }

int near_index(ivec2 step, int layer) {
  return layer * near_texels + (step.y + ring_reach) * near_side + step.x + ring_reach;
}
uvec4 near_surface(sap_place place, ivec2 step, int layer) {
  return texel_shape ? tile_surface[layer * ring_texels + ring_place(texel_blocks, place, step)]
                     : texel_surface[near_index(step, layer)];
}
vec4 near_light(sap_place place, int level, ivec2 step, int layer) {
  return texel_shape ? light_in_tile(texel_blocks, place, level, step, layer)
                     : texel_light[near_index(step, layer)];
}
uvec4 corner_surface(sap_place place, int n, int layer) {
  int i = layer * coarse_under_texels + corner_place(texel_blocks, place, n);
  return texel_shape ? tile_coarse_surface[i] : texel_corners[layer * corner_texels + n];
}
uvec4 corner_scattered(sap_place place, int level, int n, int layer) {
  int i = layer * coarse_under_texels + corner_place(texel_blocks, place, n);
  return texel_shape ? tile_coarse_scattered[i] : texel_scattered[layer * corner_texels + n];
}

ivec2 step_of(int n) { return ivec2(n % near_side, n / near_side) - ring_reach; }
// Block shape: selects the neighbourhood of the texel at `place` of the block. Returns the union of
// the words with flags.
uint take_neighbourhood(sap_place place, bool last) {
  uint bits = 0u;
  [[unroll]] for (int n = 0; n < near_texels; ++n) {
    int i = ring_place(texel_blocks, place, step_of(n));
    texel_surface[n] = ring_surface[i];
    texel_light[n] = ring_light[i];
    bits |= ring_surface[i].x;
  }
  if (last)
    return bits;
  [[unroll]] for (int n = 0; n < corner_texels; ++n) {
    int i = corner_place(texel_blocks, place, n);
    texel_corners[n] = coarse_surface[i];
    texel_scattered[n] = coarse_scattered[i];
    bits |= coarse_surface[i].x;
  }
  return bits;
}
// Block shape: reads both layers of the texel at an offset from the level's corner and, if
// requested, of its neighbours.
void read_near(texel_block block, ivec2 from_corner, int level, bool with_ring) {
  [[unroll]] for (int n = 0; n < near_texels; ++n) {
    ivec2 step = step_of(n), at = from_corner + step;
    ivec2 address = sap_address(at - texel_blocks.border, level);
    bool needed = (step == ivec2(0) || with_ring) &&
                  is_written(block, texel_blocks.border, at, level);
    uvec4 bits = needed ? read_surface(address, 0) : uvec4(0u);
    texel_surface[n] = bits;
    texel_light[n] = sap_stored_light(bits, needed ? read_light(address, 0) : vec4(0.0));
    needed = needed && has_second_near(bits);
    bits = needed ? read_surface(address, 1) : uvec4(0u);
    texel_surface[near_texels + n] = bits;
    texel_light[near_texels + n] =
        sap_stored_light(bits, needed ? read_light(address, 1) : vec4(0.0));
  }
}
// Block shape: reads both layers of the coarser texels under a texel.
void read_corners(ivec2 at, int level, bool there) {
  [[unroll]] for (int n = 0; n < corner_texels; ++n) {
    ivec2 corner = first_corner(at, level) + ivec2(n % 2, n / 2);
    ivec2 address = sap_address(corner, level + 1);
    bool needed = there && sap_inside(corner, level + 1);
    texel_corners[n] = needed ? read_coarse_surface(address, 0) : uvec4(0u);
    texel_scattered[n] = needed ? read_coarse_scattered(address, 0) : uvec4(0u);
    needed = needed && has_second_corner(texel_corners[n]);
    int second = corner_texels + n;
    texel_corners[second] = needed ? read_coarse_surface(address, 1) : uvec4(0u);
    texel_scattered[second] = needed ? read_coarse_scattered(address, 1) : uvec4(0u);
  }
}

void store_scattered(sap_place place, int level, int layer, uvec4 bits) {
  if (layer == 0)
    imageStore(scattered_image, sap_address(place.at, level), bits);
  else
    imageStore(second_scattered_image, sap_address(place.at, level), bits);
}

void main() {
  int level = settings.level;
  texel_block block;
  sap_step how = sap_step(level, settings.variant,
                          settings.variant == VARIANT_SMOOTH || level == 1,
                          !has_coarse_scattered());
  if (texel_shape) {
    if (!listed_block(texel_blocks, level, gl_LocalInvocationIndex, block))
      return;
    read_ring(block, texel_blocks, level, 2, how.smooth_level);
    if (!how.last)
      read_coarser(block, texel_blocks, level, 1);
    finish_reading();
    sap_place place = place_of(block, texel_blocks, 0, level);
    if (sap_inside(place.at, level))
      compute_layers(how, place);
    return;
  }
  begin_rounds();
  uint layered = 0u; // bit 4 r + k: texel k of round r needs more than one layer
  [[dont_unroll]] for (int round = 0; round < block_rounds; ++round) {
    if (!listed_block(texel_blocks, level, block_of_round(round), block))
      continue;
    read_ring(block, texel_blocks, level, 1, how.smooth_level);
    if (!how.last)
      read_coarser(block, texel_blocks, level, 1);
    [[unroll]] for (int k = 0; k < block_texels(texel_blocks); ++k) {
      sap_place place = place_of(block, texel_blocks, k, level);
      if (!sap_inside(place.at, level))
        continue;
      bool again = (take_neighbourhood(place, how.last) & sap_second_bit) != 0u;
      layered |= again ? 1u << (4 * round + k) : 0u;
      uvec4 bits = uvec4(0u);
      sap_texel own = sap_unpack(near_surface(place, ivec2(0), 0));
      if (own.id != 0u)
        bits = climb(how, place, own, near_light(place, level, ivec2(0), 0).rgb, 1);
      if (!again)
        store_scattered(place, level, 0, bits);
    }
  }
  finish_rounds(layered);
  uint i = gl_LocalInvocationIndex;
  if (i < count_again())
    do {
      uint next = texel_again(i);
      block = known_block(texel_blocks, level, next >> 2);
      ivec2 from_corner = block.first + block_offset(texel_blocks, int(next & 3u));
      ivec2 at = from_corner - texel_blocks.border;
      read_near(block, from_corner, level, how.smooth_level);
      read_corners(at, level, !how.last);
      compute_layers(how, sap_place(at, at & 1, 0, 0, 0, 0, 0));
      i += round_lanes;
    } while (i < count_again());
}
