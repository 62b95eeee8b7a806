#include "passes/common/reference/pixel_kernel.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace dermis::subsurface {

namespace {

// Gauss-Legendre nodes, 8 points on [-1, 1] (positive half).
constexpr std::array<double, 4> gauss_nodes = {0.1834346424956498, 0.5255324099163290,
                                               0.7966664774136267, 0.9602898564975363};
constexpr std::array<double, 4> gauss_weights = {0.3626837833783620, 0.3137066458778873,
                                                 0.2223810344533745, 0.1012285362903763};

// Adds the integral over theta in [a, b] of cdf(height / cos theta) / 2 pi.
void add_wedge(double height, double a, double b, const ProfileShape& shape, PerChannel& sum) {
  const double middle = 0.5 * (a + b), half = 0.5 * (b - a);
  for (size_t k = 0; k < gauss_nodes.size(); ++k)
    for (const double side : {-1.0, 1.0}) {
      const double rho = height / std::cos(middle + side * half * gauss_nodes[k]);
      for (size_t c = 0; c < 3; ++c)
        sum[c] += gauss_weights[k] * half * shape_cdf(shape[c], rho) / (2 * std::numbers::pi);
    }
}

// Adds the triangle between the point and one edge, in angles about the foot of the perpendicular.
void add_edge(const Vector3& from, const Vector3& to, const ProfileShape& shape, PerChannel& sum) {
  const Vector3 edge = to - from;
  const double size = length(edge);
  if (!(size > 0)) return;
  const double along_from = dot(from, edge) / size, along_to = dot(to, edge) / size;
  const double height = std::sqrt(std::max(0.0, dot(from, from) - along_from * along_from));
  const double a = std::atan2(along_from, height), b = std::atan2(along_to, height);
  const double cut = std::clamp(0.0, a, b);
  if (cut > a) add_wedge(height, a, cut, shape, sum);
  if (b > cut) add_wedge(height, cut, b, shape, sum);
}

} // namespace

ProfileShape burley_shapes(const PerChannel& d) {
  return {burley_shape(d[0]), burley_shape(d[1]), burley_shape(d[2])};
}

double reach_of(const ProfileShape& shape) {
  return std::max({shape_reach(shape[0]), shape_reach(shape[1]), shape_reach(shape[2])});
}

PerChannel patch_mean(const PixelRays& rays, const Patch& patch, double x, double y, bool near,
                      const Vector3& point, const ProfileShape& shape) {
  std::array<double, size_t{sub_points} * sub_points> radii, values;
  size_t count = 0;
  if (near) {
    constexpr double step = 1.0 / sub_points;
    for (int j = 0; j < sub_points; ++j)
      for (int i = 0; i < sub_points; ++i)
        radii[count++] = length(
            patch_point(rays, patch, x + (i + 0.5) * step - 0.5, y + (j + 0.5) * step - 0.5) -
            point);
  } else {
    radii[count++] = length(patch.position - point);
  }
  PerChannel mean{};
  for (size_t c = 0; c < 3; ++c) {
    shape_R(shape[c], std::span(radii).first(count), values);
    mean[c] = std::accumulate(values.begin(), values.begin() + count, 0.0) / double(count);
  }
  return mean;
}

PerChannel centre_integral(const PixelRays& rays, const Patch& patch, double x, double y,
                           const ProfileShape& shape) {
  const std::array<Vector3, 4> corners = {
      patch_point(rays, patch, x - 0.5, y - 0.5) - patch.position,
      patch_point(rays, patch, x + 0.5, y - 0.5) - patch.position,
      patch_point(rays, patch, x + 0.5, y + 0.5) - patch.position,
      patch_point(rays, patch, x - 0.5, y + 0.5) - patch.position};
  PerChannel sum{};
  for (size_t i = 0; i < corners.size(); ++i)
    add_edge(corners[i], corners[(i + 1) % corners.size()], shape, sum);
  return sum;
}

} // namespace dermis::subsurface
