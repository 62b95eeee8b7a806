#include "passes/subsurface/temporal/accumulate.hpp"

#include <algorithm>
#include <cmath>

namespace dermis::subsurface {

std::array<double, 4> catmull_rom(double part) {
  const double t = part, t2 = t * t, t3 = t2 * t;
  return {0.5 * (-t3 + 2 * t2 - t), 0.5 * (3 * t3 - 5 * t2 + 2), 0.5 * (-3 * t3 + 4 * t2 + t),
          0.5 * (t3 - t2)};
}

AccumulatedLight clip_to_neighbours(const AccumulatedLight& history, const std::array<double, 3>& mean,
                                    const std::array<double, 3>& deviation, double reach) {
  double keep = 1;
  for (size_t c = 0; c < 3; ++c) {
    const double way = std::abs(history.light[c] - mean[c]), room = reach * deviation[c];
    if (way > room) keep = std::min(keep, room / way);
  }
  AccumulatedLight clipped{{}, history.count * keep};
  for (size_t c = 0; c < 3; ++c)
    clipped.light[c] = mean[c] + keep * (history.light[c] - mean[c]);
  return clipped;
}

AccumulatedLight add_frame(const AccumulatedLight& history, const std::array<double, 3>& light,
                           double least) {
  const double weight = std::max(1 / (history.count + 1), least);
  AccumulatedLight sum{{}, std::min(history.count + 1, 1 / least)};
  for (size_t c = 0; c < 3; ++c)
    sum.light[c] = history.light[c] + weight * (light[c] - history.light[c]);
  return sum;
}

} // namespace dermis::subsurface
