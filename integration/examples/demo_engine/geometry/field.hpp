#pragma once
// Signed distances to simple shapes and their soft unions. After Quilez, "distance functions" and
// "smooth minimum" (iquilezles.org); the ellipsoid is his first-order bound. Distances are negative
// inside and in the unit of the arguments.

#include <glm/glm.hpp>

#include <algorithm>
#include <cmath>
#include <functional>

namespace demo {

using Field = std::function<float(const glm::vec3&)>;

inline float sphere(const glm::vec3& p, const glm::vec3& center, float radius) {
  return glm::length(p - center) - radius;
}

inline float ellipsoid(const glm::vec3& p, const glm::vec3& center, const glm::vec3& radii) {
  const glm::vec3 q = p - center;
  const float k0 = glm::length(q / radii), k1 = glm::length(q / (radii * radii));
  return k1 > 0.0f ? k0 * (k0 - 1.0f) / k1 : -std::min({radii.x, radii.y, radii.z});
}

// Returns the distance to a cone between two balls; a capsule for equal radii.
inline float round_cone(const glm::vec3& p, const glm::vec3& a, const glm::vec3& b, float ra,
                        float rb) {
  const glm::vec3 ab = b - a;
  const float t = std::clamp(glm::dot(p - a, ab) / glm::dot(ab, ab), 0.0f, 1.0f);
  return glm::length(p - a - ab * t) - (ra + (rb - ra) * t);
}

inline float torus(const glm::vec3& p, const glm::vec3& center, const glm::vec3& axis, float radius,
                   float tube) {
  const glm::vec3 q = p - center;
  const float along = glm::dot(q, axis);
  const float across = glm::length(q - axis * along) - radius;
  return std::sqrt(along * along + across * across) - tube;
}

// Returns a union whose seam is blended over about `k`.
inline float soft_union(float a, float b, float k) {
  const float h = std::max(k - std::abs(a - b), 0.0f) / k;
  return std::min(a, b) - h * h * h * k * (1.0f / 6.0f);
}

inline float soft_intersection(float a, float b, float k) {
  return -soft_union(-a, -b, k);
}

// Returns `a` without `b`.
inline float soft_difference(float a, float b, float k) {
  return -soft_union(-a, b, k);
}

// Returns 0 below `low`, 1 above `high`, and a smooth value between.
inline float smooth_step(float low, float high, float x) {
  const float t = std::clamp((x - low) / (high - low), 0.0f, 1.0f);
  return t * t * (3.0f - 2.0f * t);
}

} // namespace demo
