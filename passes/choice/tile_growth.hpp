#pragma once
// How many tiles will have subsurface in a frame whose counts are not back yet: a camera that runs up to a
// face brings more with each frame, and a budget has to hold in that frame, not in the one that was counted
// last.

#include <cstdint>

namespace dermis::choice {

struct TileGrowth {
  uint64_t frame = 0, tiles = 0; // counted last; frame 0: nothing was
  double growth = 1;             // expected from frame to frame, 1 .. max_growth
  double last_step = 1;          // what the last two counts say
};

inline constexpr double max_growth = 1.5;

// `tiles` with subsurface were counted in `frame`, which is newer than those before. What grew between three
// counts is expected to go on; a cut grows once, and is not.
void follow(TileGrowth& trend, uint64_t frame, uint64_t tiles);

// As many times the tiles counted last are expected in `frame`: 1 .. max_growth^2. Never below 1: time that
// a frame turns out not to need is no harm.
double growth_until(const TileGrowth& trend, uint64_t frame);

} // namespace dermis::choice
