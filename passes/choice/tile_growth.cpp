#include "passes/choice/tile_growth.hpp"

#include <algorithm>
#include <cmath>

namespace dermis::choice {
namespace {

constexpr uint64_t fewest_tiles = 8; // with fewer tiles, a change by one tile is no trend

} // namespace

void follow(TileGrowth& trend, uint64_t frame, uint64_t tiles) {
  const bool known = trend.frame != 0 && frame > trend.frame && std::min(trend.tiles, tiles) >= fewest_tiles;
  const double step =
      known ? std::pow(double(tiles) / double(trend.tiles), 1 / double(frame - trend.frame)) : 1;
  trend.growth = std::clamp(std::min(step, trend.last_step), 1.0, max_growth);
  trend.last_step = step;
  trend.frame = frame;
  trend.tiles = tiles;
}

double growth_until(const TileGrowth& trend, uint64_t frame) {
  if (trend.frame == 0 || frame <= trend.frame) return 1;
  return std::min(std::pow(trend.growth, double(frame - trend.frame)), max_growth * max_growth);
}

} // namespace dermis::choice
