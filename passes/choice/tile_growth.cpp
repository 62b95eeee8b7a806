#include "passes/choice/tile_growth.hpp"

#include <algorithm>
#include <cmath>

namespace dermis::choice {
namespace {

constexpr uint64_t min_tiles = 8; // with fewer tiles, a change by one tile is no trend

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
  return std::min(std::pow(growth_estimate.growth, double(frame - growth_estimate.frame)),
                  max_growth * max_growth);
}

} // namespace dermis::choice
