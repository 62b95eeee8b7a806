#include "tests/passes/restir/cpu/domain.hpp"

#include "passes/common/profiles/burley_profile.hpp"
#include "tests/passes/restir/cpu/word.hpp"

#include <algorithm>
#include <cmath>

namespace dermis::restir {

namespace {

constexpr double snorm_max = 32767;

uint32_t snorm(double x) {
  return static_cast<uint32_t>(std::lround(std::clamp(x, -1.0, 1.0) * snorm_max)) & 0xffffu;
}
double from_snorm(uint32_t half) {
  return std::max(static_cast<int16_t>(half & 0xffffu) / snorm_max, -1.0);
}
double sign_of(double x) {
  return x >= 0 ? 1 : -1;
}

} // namespace

double reach_in_d() {
  static const double reach = subsurface::burley_inverse_survival(1 - probe_fraction, 1);
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
      profile[c] = subsurface::burley_R(std::max(r, min_radius_in_d * d[c]), d[c]) /
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

std::array<double, 2> fold_normal(const Vector3& n) {
  const double sum = std::abs(n[0]) + std::abs(n[1]) + std::abs(n[2]), x = n[0] / sum,
               y = n[1] / sum;
  if (n[2] >= 0) return {x, y};
  return {(1 - std::abs(y)) * sign_of(x), (1 - std::abs(x)) * sign_of(y)};
}

Vector3 unfold_normal(const std::array<double, 2>& p) {
  const double up = 1 - std::abs(p[0]) - std::abs(p[1]);
  if (up >= 0) return normalize(Vector3{p[0], p[1], up});
  return normalize(
      Vector3{(1 - std::abs(p[1])) * sign_of(p[0]), (1 - std::abs(p[0])) * sign_of(p[1]), up});
}

PackedDomain pack_domain(const Domain& domain) {
  const auto folded = fold_normal(domain.normal);
  return {bits(domain.position[0]), bits(domain.position[1]),
          bits(domain.position[2]), domain.medium,
          bits(domain.d[0]),        bits(domain.d[1]),
          bits(domain.d[2]),        snorm(folded[0]) | snorm(folded[1]) << 16};
}

Domain unpack_domain(const PackedDomain& w) {
  return {{number(w[0]), number(w[1]), number(w[2])},
          unfold_normal({from_snorm(w[7]), from_snorm(w[7] >> 16)}),
          {number(w[4]), number(w[5]), number(w[6])},
          w[3]};
}

} // namespace dermis::restir
