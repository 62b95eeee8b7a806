#include "passes/common/reference/surface.hpp"

#include "passes/common/reference/parallel.hpp"

#include <algorithm>
#include <cmath>

namespace dermis::subsurface {

namespace {

Vector3 scaled(const Vector3& a, double k) {
  return {a[0] * k, a[1] * k, a[2] * k};
}

Vector3 cross(const Vector3& a, const Vector3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

// Returns the direction from the pixel towards the viewer, unit length.
Vector3 to_viewer(const PixelRays& rays, double x, double y) {
  if (!rays.perspective) return {0, 0, 1};
  const Vector3 ray = pixel_ray(rays, x, y);
  return scaled(ray, -1 / length(ray));
}

// Tilts a unit normal towards the viewer until the cosine reaches the limit.
Vector3 limited(const Vector3& normal, const Vector3& viewer) {
  const double cosine = dot(normal, viewer);
  if (cosine >= min_patch_cosine) return normal;
  const Vector3 across = normal - scaled(viewer, cosine);
  const double size = length(across);
  if (!(size > 0)) return viewer;
  const double k = std::sqrt(1 - min_patch_cosine * min_patch_cosine) / size;
  return {across[0] * k + viewer[0] * min_patch_cosine,
          across[1] * k + viewer[1] * min_patch_cosine,
          across[2] * k + viewer[2] * min_patch_cosine};
}

struct DepthImage {
  uint32_t width, height;
  std::span<const float> depth;
  std::span<const uint8_t> profile;

  bool holds(int64_t x, int64_t y, uint8_t id) const {
    if (x < 0 || y < 0 || x >= width || y >= height) return false;
    const size_t i = static_cast<size_t>(y) * width + static_cast<size_t>(x);
    return profile[i] == id && std::isfinite(depth[i]) && depth[i] > 0;
  }
  double at(int64_t x, int64_t y) const {
    return depth[static_cast<size_t>(y) * width + static_cast<size_t>(x)];
  }
};

// Returns the tangent along one axis: the difference to the neighbour (of the same profile, within
// max_patch_slope) that is nearer in depth; straight across the view if neither exists.
Vector3 tangent(const DepthImage& image, const PixelRays& rays, int64_t x, int64_t y, int64_t dx,
                int64_t dy) {
  const uint8_t id = image.profile[static_cast<size_t>(y) * image.width + static_cast<size_t>(x)];
  const double z = image.at(x, y);
  const auto here = pixel_position(rays, double(x), double(y), z);
  const double max_step = max_patch_slope * std::abs(dx != 0 ? rays.scale_x : rays.scale_y) *
                          (rays.perspective ? z : 1);
  const auto step_to = [&](int64_t side) {
    return std::abs(image.at(x + side * dx, y + side * dy) - z);
  };
  const auto belongs = [&](int64_t side) {
    return image.holds(x + side * dx, y + side * dy, id) && step_to(side) <= max_step;
  };
  const bool after = belongs(1), before = belongs(-1);
  const int64_t side = after && !(before && step_to(-1) < step_to(1)) ? 1 : -1;
  const double px = double(x + side * dx), py = double(y + side * dy);
  const double neighbour = after || before ? image.at(x + side * dx, y + side * dy) : z;
  return scaled(pixel_position(rays, px, py, neighbour) - here, double(side));
}

Patch build_patch(const DepthImage& image, const PixelRays& rays, uint32_t x, uint32_t y) {
  const size_t i = size_t{y} * image.width + x;
  if (image.profile[i] == 0 || !image.holds(x, y, image.profile[i])) return {};
  const Vector3 viewer = to_viewer(rays, x, y);
  Vector3 normal = cross(tangent(image, rays, x, y, 1, 0), tangent(image, rays, x, y, 0, 1));
  if (dot(normal, viewer) < 0) normal = scaled(normal, -1);
  const double size = length(normal);
  normal = limited(size > 0 ? scaled(normal, 1 / size) : viewer, viewer);

  const double z = image.depth[i];
  double footprint = std::abs(rays.scale_x * rays.scale_y); // perpendicular to the ray
  if (rays.perspective) footprint *= z * z / length(pixel_ray(rays, x, y));
  return {pixel_position(rays, x, y, z), normal, footprint / dot(normal, viewer)};
}

} // namespace

Vector3 pixel_ray(const PixelRays& rays, double x, double y) {
  return {rays.scale_x * x + rays.offset_x, rays.scale_y * y + rays.offset_y,
          rays.perspective ? -1.0 : 0.0};
}

Vector3 pixel_position(const PixelRays& rays, double x, double y, double depth) {
  const double k = rays.perspective ? depth : 1;
  return {(rays.scale_x * x + rays.offset_x) * k, (rays.scale_y * y + rays.offset_y) * k, -depth};
}

Vector3 patch_point(const PixelRays& rays, const Patch& patch, double x, double y) {
  const Vector3 ray = pixel_ray(rays, x, y);
  if (rays.perspective) {
    // The tilt limit keeps the quotient positive, except for pixels that span a large part of a
    // radian.
    const double z = -patch.position[2];
    const double quotient = dot(patch.normal, patch.position) / dot(patch.normal, ray);
    return scaled(ray, quotient > 0.5 * z && quotient < 2 * z ? quotient : z);
  }
  const Vector3& p = patch.position;
  const double rise =
      (patch.normal[0] * (ray[0] - p[0]) + patch.normal[1] * (ray[1] - p[1])) / patch.normal[2];
  return {ray[0], ray[1], p[2] - rise};
}

Surface build_surface(uint32_t width, uint32_t height, const PixelRays& rays,
                      std::span<const float> depth, std::span<const uint8_t> profile,
                      unsigned threads) {
  Surface surface{width, height, rays, std::vector<Patch>(size_t{width} * height)};
  const DepthImage image{width, height, depth, profile};
  parallel_for(height, 8, threads, [&](size_t y) {
    for (uint32_t x = 0; x < width; ++x)
      surface.patches[y * width + x] = build_patch(image, rays, x, static_cast<uint32_t>(y));
  });
  return surface;
}

} // namespace dermis::subsurface
