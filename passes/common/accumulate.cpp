#include "passes/common/accumulate.hpp"

#include <algorithm>

namespace dermis::subsurface {

std::array<double, 4> catmull_rom(double part) {
  const double t = part, t2 = t * t, t3 = t2 * t;
  return {0.5 * (-t3 + 2 * t2 - t), 0.5 * (3 * t3 - 5 * t2 + 2), 0.5 * (-3 * t3 + 4 * t2 + t),
          0.5 * (t3 - t2)};
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

} // namespace dermis::subsurface
