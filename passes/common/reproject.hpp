#pragma once
// Reprojection into the previous frame: finds the position of a pixel's surface, and which of the
// four texels around it show the same surface. shaders/common/reproject.glsl mirrors these
// functions under the same names, except find_history: GLSL cannot pass functions, so a kernel
// calls taps_around, shows_surface and normalised_taps.

#include "passes/common/environment.hpp"

#include <array>
#include <cstdint>
#include <functional>

namespace dermis::subsurface {

// A static camera must not blur: smaller steps, in pixels, are rounding errors. History lags behind
// a slower motion by less than its memory (tens of frames) times this.
inline constexpr double reproject_snap_px = 1.0 / 1024;
// pixels; larger values and NaN are invalid
inline constexpr double reproject_largest_velocity = 65536;
// Two depths are on one surface within this fraction of the depth under a perspective camera,
// within this many pixel sides and the rounding of kept depths (halves) under an orthographic one,
// or within this many pixels of the surface's slope. A surface was not visible if the sum of valid
// bilinear weights is below reproject_min_weight.
inline constexpr double reproject_depth_fraction = 0.02;
inline constexpr double reproject_depth_pixels = 8;
inline constexpr double reproject_depth_rounding = 1.0 / 1024;
inline constexpr double reproject_slope_pixels = 2;
inline constexpr double reproject_min_weight = 0.25;

bool history_usable(const FrameConstants& frame);

struct PreviousPosition {
  double x = 0, y = 0; // position in the previous rectangle, pixels; integers are centres
  double depth = 0;    // depth of the surface in the previous view, mm; 0: none
};

// Returns the position in the previous frame of a point that is static in the world. x, y: pixel
// now, integers are centres. `depth`: view depth now, mm.
PreviousPosition reproject(const FrameConstants& frame, double x, double y, double depth);
// Returns the position in the previous frame of a point with a velocity. velocity[0], velocity[1]:
// movement since the previous frame, including that of the camera, in pixels of this frame's
// rectangle without jitter. velocity[2]: change of the view depth by the movement of the point
// only, without the camera, world units.
PreviousPosition reproject(const FrameConstants& frame, double x, double y, double depth,
                           const std::array<double, 3>& velocity);

// Returns the distance in depth up to which two places are on one surface, mm. `depth`: in the
// previous view, mm. `rise`: change of the surface's depth over a pixel, mm.
double depth_tolerance(const FrameConstants& frame, double depth, double rise);

struct SurfaceBefore {
  double depth = 0; // mm
  uint32_t id = 0;  // 0: no surface
};

struct HistoryTaps {
  int x = 0, y = 0;               // weights of (x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1)
  std::array<double, 4> weight{}; // sum 1; all 0 if the surface was not visible
};

// Returns bilinear weights of the taps that show profile `id` within `tolerance` (mm) of the
// expected depth. Calls `at` only for pixels of the previous rectangle.
HistoryTaps find_history(const FrameConstants& frame, const PreviousPosition& place, uint32_t id,
                         double tolerance, const std::function<SurfaceBefore(int x, int y)>& at);

} // namespace dermis::subsurface
