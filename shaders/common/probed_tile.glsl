// Selects the tiles in which the error is estimated. The tiles of the render rectangle are divided
// into runs of 64, each of which provides one of its tiles with subsurface. If there are more runs
// than tiles to select, the frame uses every n-th run, from a random start.
// All kernels that include this file select the same tiles in a frame.
#ifndef DERMIS_PROBED_TILE_GLSL
#define DERMIS_PROBED_TILE_GLSL

#include "common/environment.glsl"
#include "common/hash.glsl"
#include "common/tile_packing.glsl"

// Returns an element of the buffer `classes`. The kernel that includes this file defines the
// function.
uint class_at(int tile);

const uint run_tiles = 64u;
shared uint listed[run_tiles]; // tiles of the run with subsurface, in order
shared uint listed_count;

struct probed_tile {
  int tile;           // index in the render rectangle
  float represented;  // number of tiles with subsurface that the tile represents
};

// Returns whether this frame is probed: if the choice by budget asks for it, and one in `interval`
// frames, at random, so that light that changes periodically is seen at all its phases.
bool is_frame_probed(int interval) {
  return interval <= 1 || (frame.flags & 32u) != 0u ||
         unit_from_hash(pcg3d(uvec3(frame.frame_index, 0u, 7u))).x * float(interval) < 1.0;
}

// Finds the probed tile of the group; a frame has up to `tiles` of them. Returns false if the group
// has none. All invocations of the group, at least 64, call the function.
bool find_probed_tile(int tiles, int interval, out probed_tile found) {
  uint lane = gl_LocalInvocationIndex, number = gl_WorkGroupID.x;
  uint runs = (uint(frame.tiles.x * frame.tiles.y) + run_tiles - 1u) / run_tiles;
  found = probed_tile(0, 0.0);
  if (number >= min(uint(tiles), runs) || !is_frame_probed(interval))
    return false;
  // Every run is selected with the same probability.
  float runs_per_tile = max(float(runs) / float(tiles), 1.0);
  float start = unit_from_hash(pcg3d(uvec3(frame.frame_index, 0u, 0u))).x;
  uint run = runs_per_tile > 1.0
                 ? min(uint((float(number) + start) * runs_per_tile), runs - 1u)
                 : number;
  if (lane < run_tiles) {
    uint tile = run * run_tiles + lane;
    listed[lane] = tile < uint(frame.tiles.x * frame.tiles.y) ? class_of_tile(class_at(int(tile)))
                                                              : class_none;
  }
  barrier();
  if (lane == 0u) {
    listed_count = 0u;
    for (uint i = 0u; i < run_tiles; ++i)
      if (listed[i] != class_none)
        listed[listed_count++] = run * run_tiles + i;
  }
  barrier();
  uint count = listed_count;
  if (count == 0u)
    return false;
  uvec3 random_bits = pcg3d(uvec3(frame.frame_index, run, 1u));
  uint place = min(uint(unit_from_hash(random_bits).x * float(count)), count - 1u);
  found = probed_tile(int(listed[place]), float(count) * runs_per_tile);
  return true;
}

// Returns the position of a tile in the render rectangle, in tiles.
ivec2 position_of_tile(int tile) { return ivec2(tile % frame.tiles.x, tile / frame.tiles.x); }

#endif
