#include "passes/common/accumulate.hpp"

#include <algorithm>
#include <cmath>

namespace dermis::subsurface {

std::array<double, 4> catmull_rom(double part) {
  const double t = part, t2 = t * t, t3 = t2 * t;
  return {0.5 * (-t3 + 2 * t2 - t), 0.5 * (3 * t3 - 5 * t2 + 2), 0.5 * (-3 * t3 + 4 * t2 + t),
          0.5 * (t3 - t2)};
}

AccumulatedLight clip_to_neighbours(const AccumulatedLight& history,
                                    const std::array<double, 3>& mean,
                                    const std::array<double, 3>& deviation, double reach) {
  double keep = 1;
  for (size_t c = 0; c < 3; ++c) {
    const double way = std::abs(history.light[c] - mean[c]), box_half = reach * deviation[c];
    if (way > box_half) keep = std::min(keep, box_half / way);
  }
  AccumulatedLight clipped{{}, history.count * keep};
  for (size_t c = 0; c < 3; ++c)
    clipped.light[c] = mean[c] + keep * (history.light[c] - mean[c]);
  return clipped;
}

double frame_weight(double count, double minimum) {
  return std::max(1 / (count + 1), minimum);
}

AccumulatedLight add_frame(const AccumulatedLight& history, const std::array<double, 3>& light,
                           double minimum) {
  const double weight = frame_weight(history.count, minimum);
  AccumulatedLight sum{{}, std::min(history.count + 1, 1 / minimum)};
  for (size_t c = 0; c < 3; ++c)
    sum.light[c] = history.light[c] + weight * (light[c] - history.light[c]);
  return sum;
}

std::array<double, 3> remainder_of(const std::array<double, 3>& light,
                                   const std::array<double, 3>& near,
                                   const std::array<double, 3>& local_mean) {
  std::array<double, 3> remainder{};
  for (size_t c = 0; c < 3; ++c)
    remainder[c] = (light[c] - near[c]) / std::max(local_mean[c], accumulate_min_mean);
  return remainder;
}

bool can_be_kept(const std::array<double, 3>& remainder) {
  return std::all_of(remainder.begin(), remainder.end(),
                     [](double one) { return std::abs(one) <= accumulate_largest_remainder; });
}

std::array<double, 3> light_of_remainder(const std::array<double, 3>& remainder,
                                         const std::array<double, 3>& near,
                                         const std::array<double, 3>& local_mean) {
  std::array<double, 3> light{};
  for (size_t c = 0; c < 3; ++c)
    light[c] = std::max(near[c] + local_mean[c] * remainder[c], 0.0);
  return light;
}

} // namespace dermis::subsurface
