#include "integration/tools/command/bench/dynamic/accumulation.hpp"

#include "passes/common/environment.hpp"
#include "passes/common/reference/parallel.hpp"
#include "passes/common/reproject.hpp"

#include <algorithm>
#include <cmath>

namespace dermis::tools {
namespace {

using namespace subsurface;

constexpr double weight = 0.1, mm_per_metre = 1000;

FrameConstants constants_of(const FrameDescription& frame) {
  FrameInput input;
  input.rect_width = input.previous_width = frame.render.width;
  input.rect_height = input.previous_height = frame.render.height;
  input.camera.clip_from_view = frame.clip_from_view;
  input.metres_per_unit = frame.metres_per_unit;
  input.depth_kind = DepthKind::view_units;
  input.camera.previous_clip_from_view = frame.previous_clip_from_view;
  input.camera.view_from_world = frame.view_from_world;
  input.camera.previous_view_from_world = frame.previous_view_from_world;
  FrameConstants constants{};
  if (!fill_frame_constants(input, constants)) constants.flags |= 4; // no history
  return constants;
}

// Contents of the previous frame.
struct Past {
  const std::vector<AccumulatedLight>& mean;
  const std::vector<float>& depth;
  const std::vector<uint8_t>& profile;
  int width = 0, height = 0;

  size_t index(int x, int y) const { return size_t(y) * size_t(width) + size_t(x); }
  bool shows(int x, int y, uint32_t id, double at, double tolerance) const {
    if (x < 0 || y < 0 || x >= width || y >= height) return false;
    const size_t i = index(x, y);
    return profile[i] == id && std::abs(double(depth[i]) - at) <= tolerance;
  }
  void add(AccumulatedLight& sum, double fraction, int x, int y) const {
    const AccumulatedLight& one = mean[index(x, y)];
    for (size_t c = 0; c < 3; ++c)
      sum.light[c] += fraction * one.light[c];
    sum.count += fraction * one.count;
  }
};

// Interpolates cubically if all neighbouring texels show the surface, otherwise bilinearly over
// those that do, as common/subsurface_accumulate.comp.
AccumulatedLight find_light(const FrameConstants& frame, const Past& past,
                            const PreviousPosition& place, uint32_t id, double tolerance) {
  const HistoryTaps taps = find_history(frame, place, id, tolerance, [&](int x, int y) {
    const size_t i = past.index(x, y);
    return SurfaceBefore{double(past.depth[i]), past.profile[i]};
  });
  AccumulatedLight sum{};
  if (taps.weight == std::array<double, 4>{}) return sum;
  const std::array<double, 4> across = catmull_rom(place.x - taps.x),
                              down = catmull_rom(place.y - taps.y);
  bool sharp = true;
  for (int k = 0; k < 16 && sharp; ++k) {
    const double fraction = across[size_t(k & 3)] * down[size_t(k >> 2)];
    const int x = taps.x + (k & 3) - 1, y = taps.y + (k >> 2) - 1;
    if (fraction == 0) continue;
    sharp = past.shows(x, y, id, place.depth, tolerance);
    if (sharp) past.add(sum, fraction, x, y);
  }
  if (!sharp) {
    sum = {};
    for (int k = 0; k < 4; ++k)
      if (taps.weight[size_t(k)] > 0)
        past.add(sum, taps.weight[size_t(k)], taps.x + (k & 1), taps.y + (k >> 1));
  }
  for (double& value : sum.light)
    value = std::max(value, 0.0);
  sum.count = std::max(sum.count, 0.0);
  return sum;
}

// Returns the smaller depth step to both sides in x and in y, mm.
double rise_of(const std::vector<float>& depth, const std::vector<uint8_t>& profile, int width,
               int height, int x, int y) {
  const auto i = [&](int at_x, int at_y) { return size_t(at_y) * size_t(width) + size_t(at_x); };
  const size_t own = i(x, y);
  double steps[2] = {0, 0};
  for (int axis = 0; axis < 2; ++axis) {
    double minimum = 1e30;
    for (const int side : {-1, 1}) {
      const int u = x + (axis == 0 ? side : 0), v = y + (axis == 1 ? side : 0);
      if (u < 0 || v < 0 || u >= width || v >= height || profile[i(u, v)] != profile[own]) continue;
      minimum = std::min(minimum, double(std::abs(depth[i(u, v)] - depth[own])));
    }
    if (minimum < 1e30) steps[axis] = minimum;
  }
  return std::hypot(steps[0], steps[1]);
}

} // namespace

const std::vector<AccumulatedLight>&
Accumulation::add(const CapturedFrame& frame, const std::vector<float>& light, bool follows) {
  const int width = int(frame.description.width), height = int(frame.description.height);
  std::vector<float> depth = frame.depth.values;
  for (float& value : depth)
    value *= static_cast<float>(mm_per_metre);
  const FrameConstants constants = constants_of(frame.description);
  const bool usable = follows && history_usable(constants) && mean_.size() == depth.size();
  const Past past{mean_, depth_, profile_, width, height};
  std::vector<AccumulatedLight> now(depth.size());
  parallel_for(size_t(height), 1, 0, [&](size_t row) {
    const int y = int(row);
    for (int x = 0; x < width; ++x) {
      const size_t i = past.index(x, y);
      const uint32_t id = frame.profile[i];
      if (id == 0 || !(depth[i] > 0)) continue;
      AccumulatedLight before{};
      if (usable) {
        std::array<double, 3> velocity{};
        const bool moves = !frame.velocity.values.empty();
        if (moves)
          for (size_t c = 0; c < 2; ++c)
            velocity[c] = double(frame.velocity.at(uint32_t(x), uint32_t(row), uint32_t(c)));
        const PreviousPosition place = moves
                                           ? reproject(constants, x, y, double(depth[i]), velocity)
                                           : reproject(constants, x, y, double(depth[i]));
        before = find_light(constants, past, place, id,
                            depth_tolerance(constants, place.depth,
                                            rise_of(depth, frame.profile, width, height, x, y)));
      }
      now[i] = add_frame(before,
                         {double(light[3 * i]), double(light[3 * i + 1]), double(light[3 * i + 2])},
                         weight);
    }
  });
  mean_ = std::move(now);
  depth_ = std::move(depth);
  profile_ = frame.profile;
  return mean_;
}

} // namespace dermis::tools
