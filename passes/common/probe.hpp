#pragma once
// Evaluates the samples of shaders/common/subsurface_probe.comp as an estimate of a frame's error.

#include "passes/common/environment.hpp"

namespace dermis::subsurface {

struct ProbedError {  // error of exposed linear luminance over the pixels that scatter
  uint32_t tiles = 0; // number of probed tiles
  // mean squared errors of the picture, of the light before scattering, and of what
  // subsurface.separable with 25 taps would show; noise may exceed them
  double square = 0, unscattered_square = 0, separable_square = 0;
  double rmse = 0;          // root of `square`, or 0
  double low = 0, high = 0; // 95 % confidence interval; 0 and infinity for fewer than two tiles
};

// Computes the ratio of the sums that the tiles represent. The variance follows from the residuals
// of tiles as if they were independent samples, with Student's t. The actual samples at even
// distances have less variance if errors change slowly (Cochran 1977, "Sampling Techniques", 6.3
// and 8.5). `tiles` is 0 if nothing was probed.
ProbedError probed_error(const FrameCounters& counters);

} // namespace dermis::subsurface
