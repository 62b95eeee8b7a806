// Neighbourhoods on the way up for a group that computes a tile of level `level` and, before, the
// texels of all coarser levels on which the tile depends. These texels form a window in each level:
// 8x8, 5x5, 4x4, then 3x3. The group reads every window with a ring of one texel into shared
// memory, and passes the values of a window to the next finer one in shared memory.
// Include after bindings with `light`, `surface`, `second_light`, `second_surface`, `levels` and
// `level_tiles`, and after `block_width` and `block_height`.
#ifndef DERMIS_SAP_WINDOW_GLSL
#define DERMIS_SAP_WINDOW_GLSL

#include "sap/sap_levels.glsl"
#include "sap/sap_tiles.glsl"

const int near_centre = 4, near_texels = 9, corner_texels = 4;
ivec2 near_step(int n) { return ivec2(n % 3 - 1, n / 3 - 1); }

const int tile_ring_texels = 10 * 10;
// Windows of the coarser levels: at most 5x5 texels.
const int max_window_texels = 5 * 5;
const int max_ring_texels = tile_ring_texels + 7 * 7 + 6 * 6 + 2 * 5 * 5; // five levels
const int max_windows = 5;
shared uvec4 ring_surface[max_ring_texels];
shared uvec2 ring_light[max_ring_texels]; // halves, exact unless `storage` is full
// Values of both layers of the window of a level, by the parity of the level.
shared uvec4 window_scattered[2][2][max_window_texels];
// Tiles of the coarser levels that are listed: 2x2 tiles from the one of the ring's first texel on.
shared uint listed_tiles[max_windows];

// A texel that is computed.
struct sap_place {
  ivec2 at;    // texel of its level
  ivec2 odd;   // parity of its position
  int window;  // of its level: 0 for `level`
  int ring;    // its index in `ring_surface`
  int corner;  // index of its first corner there
  int handed;  // index of its first corner in `window_scattered`
  int index;   // its own index there
};

struct sap_window {
  ivec2 first; // texel of its level
  int side;
  int ring;    // index of the first texel of the ring
};
int window_side(int window) { return window == 0 ? 8 : max(6 - window, 3); }
// Returns the window of the level that is `window` levels coarser than `level`.
sap_window window_of(ivec2 tile, int window) {
  sap_window found = sap_window(8 * tile - 1, 8, 0);
  for (int w = 0; w < window; ++w) {
    int with_ring = window_side(w) + 2;
    found.ring += with_ring * with_ring;
    found.first = (found.first - 1) >> 1;
  }
  found.side = window_side(window);
  return found;
}

// Finds the listed tiles of the coarser levels under the windows of a tile.
void find_listed_tiles(ivec2 tile, int windows) {
  if (gl_LocalInvocationIndex < uint(max_windows))
    listed_tiles[gl_LocalInvocationIndex] = 0u;
  barrier();
  for (int w = 1; w < windows; ++w) {
    ivec2 first = window_of(tile, w).first >> 3; // address of the ring's first texel: first - 1 + 1
    uvec2 list = level_tiles_data[settings.level + w];
    [[dont_unroll]] for (uint i = gl_LocalInvocationIndex; i < list.y; i += group_lanes) {
      ivec2 away = tile_of_entry(level_tiles_data[list.x + i]) - first;
      if (all(greaterThanEqual(away, ivec2(0))) && all(lessThan(away, ivec2(2))))
        atomicOr(listed_tiles[w], 1u << uint(2 * away.y + away.x));
    }
  }
  barrier();
}

uvec4 level_surface(ivec2 at, int window, int layer) {
  ivec2 address = sap_address(at, settings.level + window);
  if (window > 0)
    return texelFetch(levels_image,
                      place_in_levels(address, window - 1, surface_in_levels + layer), 0);
  return layer == 0 ? texelFetch(surface_image, address, 0)
                    : texelFetch(second_surface_image, address, 0);
}
vec4 level_light(ivec2 at, int window, int layer) {
  ivec2 address = sap_address(at, settings.level + window);
  if (window > 0)
    return light_from_bits(texelFetch(
        levels_image, place_in_levels(address, window - 1, light_in_levels + layer), 0));
  return sap_light(level_surface(at, 0, layer),
                   layer == 0 ? texelFetch(light_image, address, 0)
                              : texelFetch(second_light_image, address, 0),
                   settings.storage == STORAGE_FULL);
}

// Returns whether a texel of a window or of its ring was written.
bool is_written(texel_block block, sap_window window, ivec2 at, int w) {
  if (!sap_inside(at, settings.level + w))
    return false;
  ivec2 tile = (at + 1) >> 3;
  if (w == 0)
    return tile_written(block.around, tile - block.tile + 1);
  ivec2 away = tile - (window.first >> 3);
  return (listed_tiles[w] >> uint(2 * away.y + away.x) & 1u) != 0u;
}

// Reads the windows of a tile and their rings.
void read_windows(texel_block block, int windows) {
  find_listed_tiles(block.tile, windows);
  for (int w = 0; w < windows; ++w) {
    sap_window window = window_of(block.tile, w);
    int across = window.side + 2;
    [[dont_unroll]] for (int i = int(gl_LocalInvocationIndex); i < across * across;
                         i += int(group_lanes)) {
      ivec2 at = window.first - 1 + ivec2(i % across, i / across);
      uvec4 bits = uvec4(0u);
      vec4 light = vec4(0.0);
      if (is_written(block, window, at, w)) {
        bits = level_surface(at, w, 0);
        light = level_light(at, w, 0);
      }
      ring_surface[window.ring + i] = bits;
      ring_light[window.ring + i] = uvec2(packHalf2x16(light.rg), packHalf2x16(light.ba));
    }
  }
  barrier();
}

// Returns texel i of a window, row by row. `coarser`: the window of the coarser level.
sap_place place_in_window(sap_window window, sap_window coarser, int w, int i) {
  ivec2 local = ivec2(i % window.side, i / window.side);
  ivec2 at = window.first + local, corner = ((at - 1) >> 1) - coarser.first;
  return sap_place(at, at & 1, w, window.ring + (local.y + 1) * (window.side + 2) + local.x + 1,
                   coarser.ring + (corner.y + 1) * (coarser.side + 2) + corner.x + 1,
                   corner.y * coarser.side + corner.x, i);
}

int ring_place(sap_place place, int n) {
  return place.ring + (window_side(place.window) + 2) * near_step(n).y + near_step(n).x;
}
uvec4 near_bits(sap_place place, int n) { return ring_surface[ring_place(place, n)]; }
vec4 light_near(sap_place place, int level, int n) {
  vec4 light = vec4(0.0);
  if (settings.storage != STORAGE_FULL) {
    uvec2 bits = ring_light[ring_place(place, n)];
    light = vec4(unpackHalf2x16(bits.x), unpackHalf2x16(bits.y));
  } else if (n == near_centre || near_bits(place, n).w != 0u) {
    light = level_light(place.at + near_step(n), place.window, 0);
  }
  return light;
}
uvec4 second_near_bits(sap_place place, int level, int n) {
  return level_surface(place.at + near_step(n), place.window, 1);
}
vec4 second_light_near(sap_place place, int level, int n) {
  return level_light(place.at + near_step(n), place.window, 1);
}

bool has_second_corner(uvec4 bits) { return sap_has_second(bits); }
uvec4 corner_bits(sap_place place, int n) {
  return ring_surface[place.corner + n / 2 * (window_side(place.window + 1) + 2) + n % 2];
}
int handed_place(sap_place place, int n) {
  return place.handed + n / 2 * window_side(place.window + 1) + n % 2;
}
uvec4 scattered_at_corner(sap_place place, int n) {
  return window_scattered[(settings.level + place.window + 1) & 1][0][handed_place(place, n)];
}
uvec4 second_corner_bits(sap_place place, int level, int n) {
  return level_surface(((place.at - 1) >> 1) + ivec2(n % 2, n / 2), place.window + 1, 1);
}
uvec4 second_scattered_at_corner(sap_place place, int level, int n) {
  return window_scattered[(level + 1) & 1][1][handed_place(place, n)];
}

#endif
