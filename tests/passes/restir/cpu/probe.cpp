#include "tests/passes/restir/cpu/probe.hpp"

#include "passes/common/profiles/burley_profile.hpp"

#include <algorithm>
#include <numbers>

namespace dermis::restir {

namespace {

uint32_t scattering_channels(const Vector3& d) {
  return (d[0] > 0) + (d[1] > 0) + (d[2] > 0);
}

// Returns the coordinates of `offset` on the disc perpendicular to an axis.
std::array<double, 2> on_disc(const Domain& domain, uint32_t axis, const Vector3& offset) {
  return {dot(offset, probe_axis(domain.normal, (axis + 1) % 3)),
          dot(offset, probe_axis(domain.normal, (axis + 2) % 3))};
}

} // namespace

ProbeNumbers draw_numbers(const Vector3& d, const std::array<double, 4>& u) {
  ProbeNumbers numbers;
  double below = 0;
  while (numbers.axis < 2 && u[0] >= below + probe_axis_fraction[numbers.axis])
    below += probe_axis_fraction[numbers.axis++];
  const uint32_t channels = std::max(1u, scattering_channels(d));
  const double rest = (u[0] - below) / probe_axis_fraction[numbers.axis];
  uint32_t skip = picked_hit(rest, channels);
  for (uint32_t c = 0; c < 3; ++c)
    if (d[c] > 0 && skip-- == 0) {
      numbers.channel = c;
      break;
    }
  numbers.survival = 1 - probe_fraction * u[1];
  numbers.angle = u[2];
  numbers.pick = u[3];
  return numbers;
}

ProbeRay probe_of(const Domain& domain, const ProbeNumbers& numbers) {
  const double d = domain.d[numbers.channel];
  const double r = subsurface::burley_inverse_survival(numbers.survival, d);
  const double reach = reach_in_d() * d, phi = 2 * std::numbers::pi * numbers.angle;
  const double half = std::sqrt(std::max(0.0, reach * reach - r * r));
  const Vector3 axis = probe_axis(domain.normal, numbers.axis);
  const Vector3 point = domain.position +
                        r * std::cos(phi) * probe_axis(domain.normal, (numbers.axis + 1) % 3) +
                        r * std::sin(phi) * probe_axis(domain.normal, (numbers.axis + 2) % 3);
  return {point + half * axis, -axis, 2 * half};
}

uint32_t picked_hit(double pick, uint32_t count) {
  return std::min(static_cast<uint32_t>(std::max(pick, 0.0) * count), count - 1);
}

double probe_technique_pdf(const Domain& domain, uint32_t axis, uint32_t channel,
                           const Vector3& position, const Vector3& normal) {
  const double d = domain.d[channel];
  const Vector3 offset = position - domain.position;
  if (!(d > 0) || !(length(offset) <= reach_in_d() * d)) return 0;
  const auto place = on_disc(domain, axis, offset);
  const double r = std::max(std::hypot(place[0], place[1]), min_radius_in_d * d);
  const double cosine = std::abs(dot(normal, probe_axis(domain.normal, axis)));
  return probe_axis_fraction[axis] / scattering_channels(domain.d) * cosine *
         subsurface::burley_R(r, d) / probe_fraction;
}

double probe_pdf(const Domain& domain, const Vector3& position, const Vector3& normal) {
  double sum = 0;
  for (uint32_t axis = 0; axis < 3; ++axis)
    for (uint32_t channel = 0; channel < 3; ++channel)
      sum += probe_technique_pdf(domain, axis, channel, position, normal);
  return sum;
}

bool invert_point(const Domain& domain, const Vector3& position, const Vector3& normal, double u,
                  ProbeNumbers& numbers) {
  double left = u * probe_pdf(domain, position, normal);
  bool found = false;
  for (uint32_t technique = 0; technique < 9; ++technique) {
    const double pdf = probe_technique_pdf(domain, technique / 3, technique % 3, position, normal);
    if (!(pdf > 0)) continue;
    // Rounding may leave a rest after the last technique, which is then used.
    numbers.axis = technique / 3;
    numbers.channel = technique % 3;
    found = true;
    if (left < pdf) break;
    left -= pdf;
  }
  if (!found) return false;
  const auto place = on_disc(domain, numbers.axis, position - domain.position);
  const double d = domain.d[numbers.channel], r = std::hypot(place[0], place[1]);
  numbers.survival = std::clamp(1 - subsurface::burley_cdf(r, d), 1 - probe_fraction, 1.0);
  const double turn = std::atan2(place[1], place[0]) / (2 * std::numbers::pi);
  numbers.angle = turn < 0 ? turn + 1 : turn;
  numbers.pick = 0;
  return true;
}

bool invert_pick(const ProbeHits& hits, uint32_t instance, uint32_t primitive, double u,
                 double& pick) {
  for (uint32_t i = 0; i < hits.count; ++i)
    if (hits.hit[i].instance == instance && hits.hit[i].primitive == primitive) {
      pick = (i + u) / hits.count;
      return true;
    }
  return false;
}

} // namespace dermis::restir
