// Neighbourhoods on the way up for a group that computes a tile of a level and, before, the
// texels of all coarser levels on which the tile depends. These texels form a window in each level:
// 8x8, 5x5, 4x4, then 3x3. The group reads both layers of every window with a ring of one texel
// into shared memory, and passes the values of a window to the next finer one in shared memory.
#ifndef DERMIS_SAP_WINDOW_GLSL
#define DERMIS_SAP_WINDOW_GLSL

#include "sap/sap_tiles.glsl"
#include "sap/sap_up.glsl"

// The kernel that includes this file defines both functions. They return the surface and light of
// a layer (0 or 1) of a texel at an address. `window`: number of its level, 0 for the tile's level.
// `bits`: its surface.
uvec4 level_surface(ivec2 address, int window, int layer);
vec4 level_light(ivec2 address, int window, int layer, uvec4 bits);

const int tile_ring_texels = 10 * 10;
// Windows of the coarser levels: at most 5x5 texels.
const int max_window_texels = 5 * 5;
const int max_ring_texels = tile_ring_texels + 7 * 7 + 6 * 6 + 2 * 5 * 5; // five levels
const int max_windows = 5;
// The second layers follow the first ones.
shared uvec4 ring_surface[2 * max_ring_texels];
shared uvec2 ring_light[2 * max_ring_texels]; // halves, exact unless `storage` is full
// Values of both layers of the window of a level, by the parity of the level.
shared uvec4 window_scattered[2][2][max_window_texels];
// Tiles of the coarser levels that are listed: 2x2 tiles from the one of the ring's first texel on.
shared uint listed_tiles[max_windows];

struct sap_window {
  ivec2 first; // texel of its level
  int side;
  int ring;    // index of the first texel of the ring
};
int window_side(int window) { return window == 0 ? 8 : max(6 - window, 3); }
// Returns the index of the first texel of the ring of a window; for 5, the number of texels.
int window_ring(int window) {
  return window == 0   ? 0
         : window == 1 ? 100
         : window == 2 ? 149
                       : 185 + (window - 3) * 5 * 5;
}
// Returns the window of the level that is `window` levels coarser than `level`.
sap_window window_of(ivec2 tile, int window) {
  sap_window found = sap_window(8 * tile - 1, window_side(window), window_ring(window));
  [[unroll]] for (int w = 1; w < max_windows; ++w)
    found.first = w <= window ? (found.first - 1) >> 1 : found.first;
  return found;
}

// Finds the listed tiles of the coarser levels under the windows of a tile. The invocations divide
// the levels among them, so that they wait for memory once.
void find_listed_tiles(ivec2 tile, int level, int windows, uint lanes) {
  if (gl_LocalInvocationIndex < uint(max_windows))
    listed_tiles[gl_LocalInvocationIndex] = 0u;
  barrier();
  lanes /= uint(max_windows - 1);
  int w = 1 + int(gl_LocalInvocationIndex / lanes);
  if (w < windows) {
    ivec2 first = window_of(tile, w).first >> 3; // address of the ring's first texel: first - 1 + 1
    uvec2 list = level_tiles_at(uint(level + w));
    [[dont_unroll]] for (uint i = gl_LocalInvocationIndex % lanes; i < list.y; i += lanes) {
      ivec2 away = tile_of_entry(level_tiles_at(list.x + i)) - first;
      if (all(greaterThanEqual(away, ivec2(0))) && all(lessThan(away, ivec2(2))))
        atomicOr(listed_tiles[w], 1u << uint(2 * away.y + away.x));
    }
  }
  barrier();
}

// A texel that an invocation reads into shared memory.
struct ring_texel {
  int window;
  ivec2 address;
  bool needed; // it was written
};
// Returns texel i of the rings of all windows.
ring_texel ring_texel_of(texel_block block, int level, int i, bool coarser) {
  ring_texel texel;
  texel.window = coarser ? 1 + int(i >= window_ring(2)) + int(i >= window_ring(3)) +
                               int(i >= window_ring(4))
                         : 0;
  sap_window window = window_of(block.tile, texel.window);
  int local = i - window.ring, across = window.side + 2;
  // Division by 10, 7, 6 or 5, because GPUs divide integers slowly.
  int y = local * (across == 10 ? 103 : across == 7 ? 147 : across == 6 ? 171 : 205) >> 10;
  ivec2 at = window.first - 1 + ivec2(local - y * across, y);
  ivec2 tile = (at + 1) >> 3, away = tile - (window.first >> 3);
  bool written = coarser
                     ? (listed_tiles[texel.window] >> uint(2 * away.y + away.x) & 1u) != 0u
                     : tile_written(block.around, tile - block.tile + 1);
  level += texel.window;
  texel.needed = all(bvec2(written, sap_inside(at, level)));
  texel.address = mix(ivec2(0), sap_address(at, level), bvec2(texel.needed));
  return texel;
}

// Reads both layers of texels `begin` to `end` of the rings of window 0 or of all coarser windows.
// An invocation first loads several texels, so that it waits for memory once per layer; it does not
// branch around texels that were not written, but reads others instead.
void read_rings(texel_block block, int level, int begin, int end, bool coarser, int lanes) {
  const int batch = 2;
  [[dont_unroll]] for (int first = begin + int(gl_LocalInvocationIndex); first < end;
                       first += batch * lanes) {
    ring_texel texel[batch];
    uvec4 bits[batch];
    vec4 light[batch];
    [[unroll]] for (int k = 0; k < batch; ++k)
      texel[k] = ring_texel_of(block, level, first + k * lanes, coarser);
    [[unroll]] for (int layer = 0; layer < 2; ++layer) {
      [[unroll]] for (int k = 0; k < batch; ++k) {
        int window = coarser ? max(texel[k].window, 1) : 0;
        bits[k] = level_surface(texel[k].address, window, layer);
        light[k] = level_light(texel[k].address, window, layer, bits[k]);
      }
      [[unroll]] for (int k = 0; k < batch; ++k) {
        int place = first + k * lanes;
        if (place < end) {
          place += layer * max_ring_texels;
          uvec2 halves = uvec2(packHalf2x16(light[k].rg), packHalf2x16(light[k].ba));
          ring_surface[place] = mix(uvec4(0u), bits[k], bvec4(texel[k].needed));
          ring_light[place] = mix(uvec2(0u), halves, bvec2(texel[k].needed));
        }
        texel[k].needed = all(bvec2(texel[k].needed, sap_has_second(bits[k])));
        texel[k].address = mix(ivec2(0), texel[k].address, bvec2(texel[k].needed));
      }
    }
  }
}
// Reads the windows of a tile of `level` and of the coarser levels, by the `lanes` invocations of
// the group.
void read_windows(texel_block block, int level, int windows, int lanes) {
  find_listed_tiles(block.tile, level, windows, uint(lanes));
  read_rings(block, level, 0, window_ring(1), false, lanes);
  read_rings(block, level, window_ring(1), window_ring(windows), true, lanes);
  barrier();
}

// Returns texel i of a window, row by row. `coarser`: the window of the coarser level.
sap_place place_in_window(sap_window window, sap_window coarser, int w, int i) {
  ivec2 local = ivec2(i % window.side, i / window.side);
  ivec2 at = window.first + local, corner = ((at - 1) >> 1) - coarser.first;
  return sap_place(at, at & 1, window.ring + (local.y + 1) * (window.side + 2) + local.x + 1,
                   coarser.ring + (corner.y + 1) * (coarser.side + 2) + corner.x + 1, w,
                   corner.y * coarser.side + corner.x, i);
}

// The functions of sap_up.glsl.
int tent_reach() { return 1; }
bool branches_on_layers() { return true; }
bool has_second_near(uvec4 bits) { return sap_has_second(bits); }
bool has_second_corner(uvec4 bits) { return sap_has_second(bits); }
int ring_place(sap_place place, ivec2 step, int layer) {
  return layer * max_ring_texels + place.ring + (window_side(place.window) + 2) * step.y + step.x;
}
uvec4 near_surface(sap_place place, ivec2 step, int layer) {
  return ring_surface[ring_place(place, step, layer)];
}
vec4 near_light(sap_place place, int level, ivec2 step, int layer) {
  if (!stores_full()) {
    uvec2 bits = ring_light[ring_place(place, step, layer)];
    return vec4(unpackHalf2x16(bits.x), unpackHalf2x16(bits.y));
  }
  uvec4 bits = near_surface(place, step, layer);
  if (step != ivec2(0) && bits.w == 0u)
    return vec4(0.0);
  return level_light(sap_address(place.at + step, level), place.window, layer, bits);
}
uvec4 corner_surface(sap_place place, int n, int layer) {
  return ring_surface[layer * max_ring_texels + place.corner +
                      n / 2 * (window_side(place.window + 1) + 2) + n % 2];
}
uvec4 corner_scattered(sap_place place, int level, int n, int layer) {
  int i = place.handed + n / 2 * window_side(place.window + 1) + n % 2;
  return window_scattered[(level + 1) & 1][layer][i];
}

#endif
