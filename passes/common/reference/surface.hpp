#pragma once
// The surface in a depth image: each pixel's position, its patch's normal and area.

#include "passes/common/camera.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

namespace dermis::subsurface {

using Vector3 = std::array<double, 3>;

inline Vector3 operator-(const Vector3& a, const Vector3& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
inline double dot(const Vector3& a, const Vector3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline double length(const Vector3& a) {
  return std::sqrt(dot(a, a));
}

// The part of the surface covered by one pixel: the intersection of the pixel's footprint with the
// tangent plane at its centre. The plane follows from depth differences, never from a shading
// normal: on each axis from the difference to the neighbour of the same profile that is nearer in
// depth. A neighbour beyond max_patch_slope is on another surface; without a neighbour on its
// surface the patch lies across the view on that axis. Its tilt is limited: cos >=
// min_patch_cosine.
struct Patch {
  Vector3 position{}; // view space, metres
  Vector3 normal{};   // unit length, towards the viewer
  double area = 0;    // square metres, footprint / cos; 0: no subsurface
};

// 1/cos is capped at 1/0.15 (definition of the reference): a grazing patch counts for at most 6.7
// footprints.
inline constexpr double min_patch_cosine = 0.15;
// Slope of a patch at this limit, 6.59: change of depth per pixel, in sides of the pixel along the
// axis. A steeper step between two pixels cannot be one visible surface.
inline const double max_patch_slope = std::sqrt(1 / (min_patch_cosine * min_patch_cosine) - 1);

struct Surface {
  uint32_t width = 0, height = 0;
  PixelRays rays;
  std::vector<Patch> patches; // width * height, row-major
};

// Returns the direction through continuous pixel coordinates (integers are centres), with z = -1
// (perspective). For orthographic views, whose direction is (0, 0, -1), returns a point of the ray
// at depth 0.
Vector3 pixel_ray(const PixelRays& rays, double x, double y);
// Returns the point at view depth `depth` metres.
Vector3 pixel_position(const PixelRays& rays, double x, double y, double depth);
// Returns the intersection of the ray through (x, y) with the patch's plane.
Vector3 patch_point(const PixelRays& rays, const Patch& patch, double x, double y);

// Builds all patches. `depth` in metres and `profile` hold width * height values. Pixels with
// profile 0, or whose depth is not positive and finite, have area 0.
Surface build_surface(uint32_t width, uint32_t height, const PixelRays& rays,
                      std::span<const float> depth, std::span<const uint8_t> profile,
                      unsigned threads);

} // namespace dermis::subsurface
