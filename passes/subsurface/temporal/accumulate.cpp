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

void add_pixel(LightPairs& pairs, const std::array<double, 3>& now, const std::array<double, 3>& before) {
  for (size_t c = 0; c < 3; ++c) {
    pairs.now[c] += now[c];
    pairs.before[c] += before[c];
    pairs.now_squared[c] += now[c] * now[c];
    pairs.product[c] += now[c] * before[c];
    pairs.before_squared[c] += before[c] * before[c];
  }
  pairs.pixels += 1;
}

std::array<double, 3> brightness_change(const LightPairs& pairs) {
  std::array<double, 3> change = {1, 1, 1};
  if (pairs.pixels < change_least_pixels) return change;
  for (size_t c = 0; c < 3; ++c) {
    if (!(pairs.before[c] > 0)) continue;
    const double factor = pairs.now[c] / pairs.before[c];
    // Of what the factor leaves between the pixels; that of their mean, as a factor.
    const double variance = std::max(pairs.now_squared[c] - 2 * factor * pairs.product[c] +
                                         factor * factor * pairs.before_squared[c],
                                     0.0) /
                            (pairs.pixels - 1);
    const double error = variance * pairs.pixels / (pairs.before[c] * pairs.before[c]);
    const double way = (factor - 1) * (factor - 1), doubtful = change_sigmas * change_sigmas * error;
    if (way > doubtful) change[c] = 1 + (1 - doubtful / way) * (factor - 1);
  }
  return change;
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
