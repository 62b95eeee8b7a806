#include "passes/common/accumulate.hpp"

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

double frame_weight(double count, double least) {
  return std::max(1 / (count + 1), least);
}

AccumulatedLight add_frame(const AccumulatedLight& history, const std::array<double, 3>& light,
                           double least) {
  const double weight = frame_weight(history.count, least);
  AccumulatedLight sum{{}, std::min(history.count + 1, 1 / least)};
  for (size_t c = 0; c < 3; ++c)
    sum.light[c] = history.light[c] + weight * (light[c] - history.light[c]);
  return sum;
}

std::array<double, 3> remainder_of(const std::array<double, 3>& light, const std::array<double, 3>& near,
                                   const std::array<double, 3>& brightness) {
  std::array<double, 3> remainder{};
  for (size_t c = 0; c < 3; ++c)
    remainder[c] = (light[c] - near[c]) / std::max(brightness[c], accumulate_least_brightness);
  return remainder;
}

bool can_be_kept(const std::array<double, 3>& remainder) {
  return std::all_of(remainder.begin(), remainder.end(),
                     [](double one) { return std::abs(one) <= accumulate_largest_remainder; });
}

std::array<double, 3> light_of_remainder(const std::array<double, 3>& remainder,
                                         const std::array<double, 3>& near,
                                         const std::array<double, 3>& brightness) {
  std::array<double, 3> light{};
  for (size_t c = 0; c < 3; ++c)
    light[c] = std::max(near[c] + brightness[c] * remainder[c], 0.0);
  return light;
}

} // namespace dermis::subsurface
