#include "passes/common/reference/relief.hpp"

#include "passes/common/dispatch.hpp"
#include "passes/common/pass_types.hpp"
#include "passes/common/reference/surface.hpp"
#include "passes/common/uniform_light.hpp"

#include <algorithm>

namespace dermis::subsurface {
namespace {

constexpr int side_of_tile = static_cast<int>(tile_side), rows_per_run = 2;
constexpr int runs_per_tile = side_of_tile / rows_per_run;

class ReliefMeter {
public:
  explicit ReliefMeter(const ReferenceInput& frame) : input(frame) {}

  double mean() {
    for (int y = 0; y < tiles(input.height); ++y)
      for (int x = 0; x < tiles(input.width); ++x)
        if (is_counted(x, y) && scatters(x, y))
          for (int run = 0; run < runs_per_tile; ++run)
            add_run(x, y, run);
    return count > 0 ? sum / count : -1;
  }

private:
  static int tiles(uint32_t pixels) {
    return (static_cast<int>(pixels) + side_of_tile - 1) / side_of_tile;
  }
  bool inside(int x, int y) const {
    return x >= 0 && y >= 0 && x < static_cast<int>(input.width) &&
           y < static_cast<int>(input.height);
  }
  size_t index(int x, int y) const {
    return static_cast<size_t>(y) * input.width + static_cast<size_t>(x);
  }
  bool has_surface(int x, int y) const {
    if (!inside(x, y)) return false;
    const float depth = input.depth[index(x, y)];
    return input.profile[index(x, y)] != 0 && depth > 0 && std::isfinite(depth);
  }
  // Half of the blocks of tiles are counted.
  static bool is_counted(int tile_x, int tile_y) {
    constexpr int side = static_cast<int>(uniform_cell_side);
    return (tile_x / side + tile_y / side) % 2 == 0;
  }
  // Returns a function of depth that is linear in the pixel on a plane.
  double linear_depth(double depth) const { return input.rays.perspective ? 1 / depth : depth; }
  double widest_d(size_t pixel) const {
    const uint8_t id = input.profile[pixel];
    if (id == 0 || id >= input.d_m.size()) return 0;
    return *std::max_element(input.d_m[id].begin(), input.d_m[id].end());
  }
  // Sides of a pixel across the view, metres.
  std::array<double, 2> footprint(double depth) const {
    const double scale = input.rays.perspective ? depth : 1;
    return {std::abs(input.rays.scale_x) * scale, std::abs(input.rays.scale_y) * scale};
  }

  // Returns the scattering distance of a pixel, with its factor.
  double scaled_d(size_t pixel) const {
    return widest_d(pixel) * (input.scatter_scale.empty() ? 1 : double(input.scatter_scale[pixel]));
  }
  bool scatters(size_t pixel) const {
    const std::array<double, 2> side = footprint(double(input.depth[pixel]));
    return scaled_d(pixel) / std::min(side[0], side[1]) >= double(copy_below_d_px);
  }

  bool scatters(int tile_x, int tile_y) const {
    for (int y = side_of_tile * tile_y; y < side_of_tile * (tile_y + 1); ++y)
      for (int x = side_of_tile * tile_x; x < side_of_tile * (tile_x + 1); ++x) {
        if (!has_surface(x, y)) continue;
        const size_t pixel = index(x, y);
        if (scatters(pixel)) return true;
      }
    return false;
  }

  // Adds the pixel that represents the run: its fifth, or its first with subsurface.
  void add_run(int tile_x, int tile_y, int run) {
    int found = -1;
    for (int i = 0; i < rows_per_run * side_of_tile && found < 0; ++i)
      if (is_subsurface(tile_x, tile_y, run, i)) found = i;
    constexpr int middle = 4;
    if (is_subsurface(tile_x, tile_y, run, middle)) found = middle;
    if (found < 0) return;
    constexpr int side = static_cast<int>(uniform_cell_side);
    const int lane = side * ((tile_y % side) * runs_per_tile + run) + tile_x % side;
    const int turn = (lane + 5 * (tile_x / side) + 11 * (tile_y / side)) & 63;
    add_pixel(side_of_tile * tile_x + found % side_of_tile,
              side_of_tile * tile_y + rows_per_run * run + found / side_of_tile, turn);
  }
  bool is_subsurface(int tile_x, int tile_y, int run, int i) const {
    const int x = side_of_tile * tile_x + i % side_of_tile,
              y = side_of_tile * tile_y + rows_per_run * run + i / side_of_tile;
    return inside(x, y) && input.profile[index(x, y)] != 0;
  }

  void add_pixel(int x, int y, int turn) {
    const size_t pixel = index(x, y);
    const double d = scaled_d(pixel);
    if (!has_surface(x, y) || !scatters(pixel)) return;
    const std::array<double, 2> side = footprint(double(input.depth[pixel]));
    double total = 0;
    int points = 0;
    for (int i = 0; i < 2; ++i) {
      const double angle = relief_turn * (2 * turn + i),
                   radius = (i == 0 ? relief_far_d : relief_near_d) * d;
      double across = radius * std::cos(angle) / side[0], down = radius * std::sin(angle) / side[1];
      const double least = std::max(1.0, 1 / std::max(std::hypot(across, down), 1e-6));
      const auto step = [&](double offset) {
        return static_cast<int>(
            std::round(std::clamp(offset * least, -relief_max_offset, relief_max_offset)));
      };
      const int to_x = x + step(across), to_y = y + step(down);
      if (!has_surface(to_x, to_y)) continue;
      total += relief_between(x, y, to_x, to_y, d, side);
      ++points;
    }
    if (points == 0) return;
    sum += total / points;
    ++count;
  }

  // Returns the change of linear_depth per pixel towards the neighbour of the same profile that is
  // nearer in depth; 0 if that neighbour is on another surface.
  double gradient(int x, int y, int step_x, int step_y, double side) const {
    const size_t own = index(x, y);
    const double depth = double(input.depth[own]);
    const auto distance = [&](int sign) {
      const int to_x = x + sign * step_x, to_y = y + sign * step_y;
      const bool same =
          has_surface(to_x, to_y) && input.profile[index(to_x, to_y)] == input.profile[own];
      return same ? std::abs(double(input.depth[index(to_x, to_y)]) - depth) : INFINITY;
    };
    const double back = distance(-1), forth = distance(1);
    if (!(std::min(back, forth) <= max_patch_slope * side)) return 0;
    const int sign = back < forth ? -1 : 1;
    const double other = double(input.depth[index(x + sign * step_x, y + sign * step_y)]);
    return sign * (linear_depth(other) - linear_depth(depth));
  }

  double relief_between(int x, int y, int to_x, int to_y, double d,
                        const std::array<double, 2>& side) const {
    const double depth = double(input.depth[index(x, y)]);
    double plane = linear_depth(depth) + gradient(x, y, 1, 0, side[0]) * (to_x - x) +
                   gradient(x, y, 0, 1, side[1]) * (to_y - y);
    if (input.rays.perspective) plane = 1 / std::max(plane, 1e-6 / depth);
    const double off = std::abs(double(input.depth[index(to_x, to_y)]) - plane);
    const double distance = std::hypot((to_x - x) * side[0], (to_y - y) * side[1]);
    const double steepness = off / (distance * relief_width);
    return (1 - std::exp(-0.5 * steepness * steepness)) * std::exp(-off / (relief_range_d * d));
  }

  const ReferenceInput& input;
  double sum = 0;
  int64_t count = 0;
};

} // namespace

double mean_relief(const ReferenceInput& input) {
  return ReliefMeter(input).mean();
}

} // namespace dermis::subsurface
