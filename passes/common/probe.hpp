#pragma once
// What the samples of shaders/common/subsurface_probe.comp say of a frame's error.

#include "passes/common/environment.hpp"

namespace dermis::subsurface {

struct ProbedError {  // of linear luminance, exposed, over the pixels that scatter
  uint32_t tiles = 0; // that were looked at
  double rmse = 0;
  double low = 0, high = 0; // of 95 %; fewer than two tiles: 0 and infinity
};

// The ratio of the sums that the tiles stand for; its variance from the residuals of tiles, as if they were
// drawn independently, which draws at even distances beat where errors change slowly (Cochran 1977, "Sampling
// Techniques", 6.3 and 8.5); Student's t. `tiles` 0 where nothing was probed.
ProbedError probed_error(const FrameCounters& counters);

} // namespace dermis::subsurface
