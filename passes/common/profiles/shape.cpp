#include "passes/common/profiles/shape.hpp"

#include "passes/common/profiles/burley_profile.hpp"

#include <algorithm>
#include <cmath>

namespace dermis::subsurface {

namespace {

constexpr double anchor_survival = 0.01; // survival at which d of other models is matched
constexpr double burley_reach_in_d = 20; // radius of the reference
const double burley_anchor = burley_inverse_survival(anchor_survival, 1); // 12.95 d

} // namespace

ChannelShape burley_shape(double d) {
  return {.model = ProfileModel::burley, .d = d};
}

ChannelShape dipole_shape(double sigma_a, double sigma_s_prime, double eta) {
  ChannelShape shape{.model = ProfileModel::dipole,
                     .dipole = make_dipole(sigma_a, sigma_s_prime, eta)};
  shape.d = dipole_inverse_survival(anchor_survival, shape.dipole) / burley_anchor;
  return shape;
}

ChannelShape artist_shape(double width, double strength) {
  return {.model = ProfileModel::artist,
          .d = artist_inverse_survival(anchor_survival, width) / burley_anchor,
          .direct = 1 - strength,
          .width = width};
}

ChannelShape scaled(const ChannelShape& shape, double factor) {
  ChannelShape result = shape;
  result.d *= factor;
  result.width *= factor;
  result.dipole.z_real *= factor;
  result.dipole.z_virtual *= factor;
  if (factor > 0) result.dipole.sigma_tr /= factor;
  return result;
}

double shape_R(const ChannelShape& shape, double r) {
  switch (shape.model) {
  case ProfileModel::burley:
    return burley_R(r, shape.d);
  case ProfileModel::dipole:
    return dipole_R(r, shape.dipole);
  case ProfileModel::artist:
    break;
  }
  return artist_R(r, shape.width);
}

void shape_R(const ChannelShape& shape, std::span<const double> r, std::span<double> result) {
  if (shape.model == ProfileModel::burley) return burley_R(r, shape.d, result);
  // Beyond this radius numbers become denormal, which is slow.
  const double last = burley_negligible_in_d * shape.d;
  for (size_t i = 0; i < r.size(); ++i)
    result[i] = r[i] < last ? shape_R(shape, r[i]) : 0;
}

double shape_pdf(const ChannelShape& shape, double r) {
  switch (shape.model) {
  case ProfileModel::burley:
    return burley_pdf(r, shape.d);
  case ProfileModel::dipole:
    return dipole_pdf(r, shape.dipole);
  case ProfileModel::artist:
    break;
  }
  return artist_pdf(r, shape.width);
}

double shape_cdf(const ChannelShape& shape, double r) {
  if (!(shape.d > 0)) return r > 0 ? 1 : 0;
  switch (shape.model) {
  case ProfileModel::burley:
    return burley_cdf(r, shape.d);
  case ProfileModel::dipole:
    return dipole_cdf(r, shape.dipole);
  case ProfileModel::artist:
    break;
  }
  return artist_cdf(r, shape.width);
}

double shape_survival(const ChannelShape& shape, double r) {
  if (!(shape.d > 0)) return r > 0 ? 0 : 1;
  switch (shape.model) {
  case ProfileModel::burley:
    return r > 0 ? 0.25 * std::exp(-r / shape.d) + 0.75 * std::exp(-r / (3 * shape.d)) : 1;
  case ProfileModel::dipole:
    return dipole_survival(r, shape.dipole);
  case ProfileModel::artist:
    break;
  }
  return artist_survival(r, shape.width);
}

double shape_inverse_survival(const ChannelShape& shape, double u) {
  switch (shape.model) {
  case ProfileModel::burley:
    return burley_inverse_survival(u, shape.d);
  case ProfileModel::dipole:
    return dipole_inverse_survival(u, shape.dipole);
  case ProfileModel::artist:
    break;
  }
  return artist_inverse_survival(u, shape.width);
}

double shape_transfer(const ChannelShape& shape, double k) {
  if (!(shape.d > 0)) return 1;
  switch (shape.model) {
  case ProfileModel::burley: {
    const double k2 = k * k * shape.d * shape.d;
    return 0.25 / std::sqrt(1 + k2) + 0.75 / std::sqrt(1 + 9 * k2);
  }
  case ProfileModel::dipole:
    return dipole_transfer(k, shape.dipole);
  case ProfileModel::artist:
    break;
  }
  return artist_transfer(k, shape.width);
}

double shape_gamma(const ChannelShape& shape, double r0) {
  return shape.model == ProfileModel::artist ? 1 - shape.direct : shape_survival(shape, r0);
}

double shape_reach(const ChannelShape& shape) {
  if (!(shape.d > 0) || shape.model == ProfileModel::burley) return burley_reach_in_d * shape.d;
  return shape_inverse_survival(shape, shape_survival(burley_shape(1), burley_reach_in_d));
}

double direct_radius(DirectRadius mode, double width, double height) {
  return 0.5 *
         (mode == DirectRadius::inscribed ? std::min(width, height) : std::hypot(width, height));
}

} // namespace dermis::subsurface
