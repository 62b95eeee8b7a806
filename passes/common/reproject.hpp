#pragma once
// Looking back one frame: where the surface of a pixel stood, and which of the four texels around that place
// show the same surface. shaders/common/reproject.glsl mirrors these functions under the same names.

#include "passes/common/environment.hpp"

#include <array>
#include <cstdint>
#include <functional>

namespace dermis::subsurface {

// A camera that rests must not blur: steps below this are rounding. History lags behind a slower motion by
// less than its memory (tens of frames) times this.
inline constexpr double reproject_snap_px = 1.0 / 1024;
inline constexpr double reproject_largest_velocity = 65536; // pixels; beyond, and NaN, is no motion
// Two depths are one surface within this share, or within so many pixels of its slope; below this sum of
// valid bilinear weights a surface was not to be seen (issue 5 of the project's list, "Temporal").
inline constexpr double reproject_depth_fraction = 0.02;
inline constexpr double reproject_slope_pixels = 2;
inline constexpr double reproject_min_weight = 0.25;

bool history_usable(const FrameConstants& frame);

struct PreviousPlace {
  double x = 0, y = 0; // pixels of the rectangle then, integers are centres
  double depth = 0;    // that the surface had in that view, mm; 0: no place to look at
};

// Of a point that stands still in the world. `depth` in mm.
PreviousPlace place_before(const FrameConstants& frame, double x, double y, double depth);
// Of a point with a velocity: x, y = now - before in pixels of this frame's rectangle, jitter taken out;
// z = view depth now - before that the camera does not explain, world units.
PreviousPlace place_before(const FrameConstants& frame, double x, double y, double depth,
                           const std::array<double, 3>& velocity);

// Distance in depth up to which two places are one surface, mm. `rise`: change of its depth over a pixel, mm.
double depth_tolerance(double depth, double rise);

struct SurfaceBefore {
  double depth = 0; // mm
  uint32_t id = 0;  // 0: nothing
};

struct HistoryTaps {
  int x = 0, y = 0;               // weights are of (x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1)
  std::array<double, 4> weight{}; // sum 1; all 0 where the surface was not to be seen
};

// Bilinear weights of those taps that show profile `id` within `tolerance` (mm) of the expected depth. `at`
// is asked for pixels of the previous rectangle only.
HistoryTaps find_history(const FrameConstants& frame, const PreviousPlace& place, uint32_t id,
                         double tolerance, const std::function<SurfaceBefore(int x, int y)>& at);

} // namespace dermis::subsurface
