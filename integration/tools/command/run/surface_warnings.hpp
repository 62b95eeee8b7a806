#pragma once
// Warns of frames whose surfaces the techniques do not filter correctly: non-square pixels and
// dithered surfaces (docs/limits.md).

#include "framegraph/text/diagnostic.hpp"
#include "integration/tools/files/capture.hpp"

namespace dermis::tools {

// Returns the longer side of a pixel over the shorter side; 1 is square.
double pixel_aspect(const subsurface::PixelRays& rays);
// Along the axis in which pixels are longer, a pyramid skips up to two halvings, so it compensates
// for non-square pixels up to this aspect: 2^(max_pixel_doublings + 1 - pixel_doubling_bias).
inline constexpr double largest_compensated_aspect = 6;

// Returns the fraction (0..1) of the 8x8 tiles with subsurface that show a dithered surface. In
// such a tile at least an eighth of the pixels have two neighbours, along a row or a column, that
// are both nearer or both farther by more than max_patch_slope pixel sides. A screen door of a
// quarter of the pixels reaches twice an eighth.
double dithered_tiles(const CapturedFrame& frame);
// `afis` has an RMSE of 0.096 where a quarter of the pixels is 5 cm in front (docs/limits.md). This
// fraction of such tiles on its own limits a frame to 0.096 * sqrt(0.02) = 0.014, 37 dB. Shipped
// scenes have no such tile; thin parts and folds of heads flag a smaller fraction.
inline constexpr double largest_folded_tiles = 0.02;

// Adds D0508 and D0509 where they apply and `diagnostics` does not contain them yet, so that a
// sequence reports each once. Returns whether a warning was added.
bool warn_of_surfaces(const CapturedFrame& frame, Diagnostics& diagnostics);

} // namespace dermis::tools
