#include "passes/common/reproject.hpp"

#include <algorithm>
#include <cmath>

namespace dermis::subsurface {
namespace {

constexpr uint32_t history_invalid = 4, previous_perspective = 8; // bits of FrameConstants::flags

double snap(double place) {
  const double whole = std::round(place);
  return std::abs(place - whole) < reproject_snap_px ? whole : place;
}

} // namespace

bool history_usable(const FrameConstants& frame) {
  return (frame.flags & history_invalid) == 0;
}

PreviousPosition reproject(const FrameConstants& frame, double x, double y, double depth) {
  const double zoom = (frame.flags & 1) != 0 ? depth : 1;
  const double at[4] = {(double(frame.ray_scale[0]) * x + double(frame.ray_offset[0])) * zoom,
                        (double(frame.ray_scale[1]) * y + double(frame.ray_offset[1])) * zoom,
                        -depth, 1};
  double before[3] = {};
  for (size_t r = 0; r < 3; ++r)
    for (size_t c = 0; c < 4; ++c)
      before[r] += double(frame.previous_from_view[r][c]) * at[c];
  if (!(before[2] < 0)) return {};
  const double k = (frame.flags & previous_perspective) != 0 ? -before[2] : 1;
  const auto pixel = [&](size_t axis) {
    return snap((before[axis] / k - double(frame.previous_ray_offset[axis])) /
                double(frame.previous_ray_scale[axis]));
  };
  return {pixel(0), pixel(1), -before[2]};
}

PreviousPosition reproject(const FrameConstants& frame, double x, double y, double depth,
                           const std::array<double, 3>& velocity) {
  const PreviousPosition by_camera = reproject(frame, x, y, depth);
  for (const double v : velocity)
    if (!(std::abs(v) < reproject_largest_velocity)) return {};
  const auto pixel = [&](size_t axis, double now) {
    const double unjittered = (now - double(frame.jitter[axis]) - velocity[axis] + 0.5) *
                                  frame.previous_rect[2 + axis] / frame.rect[2 + axis] -
                              0.5;
    return snap(unjittered + double(frame.previous_jitter[axis]));
  };
  return {pixel(0, x), pixel(1, y),
          by_camera.depth > 0
              ? std::max(by_camera.depth - velocity[2] * double(frame.depth_unit), 0.0)
              : 0};
}

double depth_tolerance(const FrameConstants& frame, double depth, double rise) {
  const double pixel = std::max(std::abs(double(frame.previous_ray_scale[0])),
                                std::abs(double(frame.previous_ray_scale[1])));
  const double least = (frame.flags & previous_perspective) != 0
                           ? reproject_depth_fraction * depth
                           : reproject_depth_pixels * pixel + reproject_depth_rounding * depth;
  return std::max(least, reproject_slope_pixels * rise);
}

HistoryTaps find_history(const FrameConstants& frame, const PreviousPosition& place, uint32_t id,
                         double tolerance, const std::function<SurfaceBefore(int x, int y)>& at) {
  if (!(place.depth > 0) || !(std::abs(place.x) < reproject_largest_velocity) ||
      !(std::abs(place.y) < reproject_largest_velocity))
    return {};
  HistoryTaps taps{
      static_cast<int>(std::floor(place.x)), static_cast<int>(std::floor(place.y)), {}};
  const double px = place.x - taps.x, py = place.y - taps.y;
  taps.weight = {(1 - px) * (1 - py), px * (1 - py), (1 - px) * py, px * py};
  double total = 0;
  for (int i = 0; i < 4; ++i) {
    const int x = taps.x + (i & 1), y = taps.y + (i >> 1);
    double& weight = taps.weight[static_cast<size_t>(i)];
    const bool inside =
        x >= 0 && y >= 0 && x < frame.previous_rect[2] && y < frame.previous_rect[3];
    const SurfaceBefore surface = weight > 0 && inside ? at(x, y) : SurfaceBefore{};
    if (surface.id != id || !(std::abs(surface.depth - place.depth) <= tolerance)) weight = 0;
    total += weight;
  }
  if (total < reproject_min_weight) return {};
  for (double& weight : taps.weight)
    weight /= total;
  return taps;
}

} // namespace dermis::subsurface
