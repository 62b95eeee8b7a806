#pragma once
// Vectors of three as in the reference, with additional functions for tracing. Names as in GLSL.

#include "passes/common/reference/surface.hpp"

#include <cmath>

namespace dermis::restir {

using subsurface::dot;
using subsurface::length;
using subsurface::Vector3;
using subsurface::operator-;

inline Vector3 operator+(const Vector3& a, const Vector3& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
inline Vector3 operator*(const Vector3& a, const Vector3& b) {
  return {a[0] * b[0], a[1] * b[1], a[2] * b[2]};
}
inline Vector3 operator*(double s, const Vector3& a) {
  return {s * a[0], s * a[1], s * a[2]};
}
inline Vector3 operator-(const Vector3& a) {
  return {-a[0], -a[1], -a[2]};
}
inline Vector3 cross(const Vector3& a, const Vector3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline Vector3 normalize(const Vector3& a) {
  return 1 / length(a) * a;
}
// Linear Rec. 709 luminance, in which all errors are measured.
inline double luminance(const Vector3& rgb) {
  return dot(rgb, Vector3{0.2126, 0.7152, 0.0722});
}

} // namespace dermis::restir
