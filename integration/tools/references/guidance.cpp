#include "integration/tools/references/guidance.hpp"

#include <algorithm>
#include <cmath>

namespace dermis::subsurface {

double required_samples(double variance, double mean_count, const GuidanceSettings& settings) {
  const double ratio = variance / settings.sigma2_target;
  const double change = (ratio - 1) * mean_count * (2 / settings.eta - 2); // equation 9
  return settings.kappa * change + ratio * mean_count;
}

int clamped_samples(double required, const GuidanceSettings& settings) {
  return static_cast<int>(
      std::lround(std::clamp(required, settings.min_samples, settings.max_samples)));
}

double control_weight(const MovingCovariance& moments, double eps_alpha) {
  const double weight = (moments.covariance + eps_alpha) / (moments.variance_g + eps_alpha);
  if (!(moments.mean_g > 0)) return weight;
  return std::clamp(weight, 0.0, (moments.mean_f + moments.mean_g) / moments.mean_g);
}

} // namespace dermis::subsurface
