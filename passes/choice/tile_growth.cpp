#include "passes/choice/tile_growth.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dermis::choice {
namespace {

constexpr uint64_t min_tiles = 8; // with fewer tiles, a change by one tile is no trend
// Growth does not go on for longer: counts are missing because nothing was recorded.
constexpr uint64_t max_growing_frames = 8;
// A convex area A with perimeter P touches A + 2 P / pi + 1 cells of a unit grid in the mean
// (Minkowski sum with the cell, all directions). For a disc this is (sqrt(A) + border)^2 + 0.3.
const double border = 2 / std::sqrt(std::numbers::pi);

} // namespace

void update_growth(TileGrowth& growth_estimate, uint64_t frame, uint64_t tiles) {
  const bool known = growth_estimate.frame != 0 && frame > growth_estimate.frame &&
                     std::min(growth_estimate.tiles, tiles) >= min_tiles;
  const double step = known ? std::pow(double(tiles) / double(growth_estimate.tiles),
                                       1 / double(frame - growth_estimate.frame))
                            : 1;
  growth_estimate.growth = std::clamp(std::min(step, growth_estimate.last_step), 1.0, max_growth);
  growth_estimate.last_step = step;
  growth_estimate.frame = frame;
  growth_estimate.tiles = tiles;
}

double growth_until(const TileGrowth& growth_estimate, uint64_t frame) {
  if (growth_estimate.frame == 0 || frame <= growth_estimate.frame) return 1;
  const uint64_t frames = std::min(frame - growth_estimate.frame, max_growing_frames);
  return std::min(std::pow(growth_estimate.growth, double(frames)), max_growth * max_growth);
}

double scaled_tiles(double tiles, double scale) {
  if (tiles <= 0 || scale == 1) return tiles;
  const double side = std::max(std::sqrt(tiles) - border, 0.0);
  return std::max(std::pow(scale * side + border, 2), 1.0);
}

void rescale(TileGrowth& growth_estimate, double scale) {
  growth_estimate.tiles =
      static_cast<uint64_t>(std::lround(scaled_tiles(double(growth_estimate.tiles), scale)));
}

} // namespace dermis::choice
