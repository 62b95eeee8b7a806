#pragma once
// Predicts the number of tiles with subsurface in a frame whose counts have not been read back yet.
// A camera that approaches a face adds tiles with each frame, and the budget must hold in the new
// frame, not only in the frame that was counted last.

#include <cstdint>

namespace dermis::choice {

struct TileGrowth {
  uint64_t frame = 0, tiles = 0; // last count; frame 0: none
  double growth = 1;             // expected factor per frame, 1 .. max_growth
  double last_step = 1;          // factor per frame between the last two counts
};

inline constexpr double max_growth = 1.5;

// Adds the count `tiles` of tiles with subsurface in `frame`, which must be newer than earlier
// frames. Growth over three counts is expected to continue; a single jump, as at a cut, is not.
void update_growth(TileGrowth& growth_estimate, uint64_t frame, uint64_t tiles);

// Returns the expected factor on the last count in `frame`: 1 .. max_growth^2, that of at most 8
// frames. Never below 1, because an overestimate of time is harmless.
double growth_until(const TileGrowth& growth_estimate, uint64_t frame);

// Returns how many tiles with subsurface to expect if a picture with `tiles` of them is rendered
// with `scale` times as many pixels along each side.
double scaled_tiles(double tiles, double scale);
// Makes the last count that of the same picture at another scale.
void rescale(TileGrowth& growth_estimate, double scale);

} // namespace dermis::choice
