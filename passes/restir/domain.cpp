#include "passes/restir/domain.hpp"

#include "passes/subsurface/burley_profile.hpp"

#include <algorithm>

namespace dermis::restir {

double reach_in_d() {
  static const double reach = subsurface::burley_inverse_survival(1 - probe_share, 1);
  return reach;
}

double scattering_reach(const Vector3& d) {
  return reach_in_d() * std::max({d[0], d[1], d[2]});
}

Vector3 scattering_profile(const Vector3& d, double r) {
  const double reach = scattering_reach(d);
  Vector3 profile{};
  if (!(r <= reach)) return profile;
  for (size_t c = 0; c < 3; ++c)
    if (d[c] > 0)
      profile[c] = subsurface::burley_R(std::max(r, least_radius_in_d * d[c]), d[c]) /
                   subsurface::burley_cdf(reach, d[c]);
  return profile;
}

Vector3 probe_axis(const Vector3& normal, uint32_t axis) {
  const double sign = normal[2] >= 0 ? 1.0 : -1.0;
  const double a = -1 / (sign + normal[2]), b = normal[0] * normal[1] * a;
  if (axis == 1) return {1 + sign * normal[0] * normal[0] * a, sign * b, -sign * normal[0]};
  if (axis == 2) return {b, sign + normal[1] * normal[1] * a, -normal[1]};
  return normal;
}

} // namespace dermis::restir
