#include "passes/subsurface/camera.hpp"

#include <algorithm>
#include <cmath>

namespace dermis::subsurface {

// A perspective divides by -z, which is row 3: 0 0 -1 0. Where that stands in the last column, the matrix is
// on its side.
bool stored_by_columns(const Matrix4& m) {
  return m[11] == -1 && m[14] != -1;
}

std::optional<PixelRays> pixel_rays(const Matrix4& m, uint32_t width, uint32_t height, double metres_per_unit,
                                    std::array<double, 2> jitter_px) {
  const bool finite = std::all_of(m.begin(), m.end(), [](double x) { return std::isfinite(x); }) &&
                      std::isfinite(jitter_px[0]) && std::isfinite(jitter_px[1]);
  if (!finite || width == 0 || height == 0 || !(metres_per_unit > 0) || !std::isfinite(metres_per_unit))
    return std::nullopt;
  // Rows x, y and w may depend on their own axis, on z (off-centre perspective) and on 1 (off-centre ortho)
  // alone.
  if (m[1] != 0 || m[4] != 0 || m[12] != 0 || m[13] != 0 || m[0] == 0 || m[5] == 0) return std::nullopt;
  const bool perspective = m[14] < 0 && m[15] == 0 && m[3] == 0 && m[7] == 0;
  const bool orthographic = m[14] == 0 && m[15] > 0 && m[2] == 0 && m[6] == 0;
  if (!perspective && !orthographic) return std::nullopt;
  if (perspective && stored_by_columns(m)) return std::nullopt;

  // With z = -depth, w = -m[14] depth (perspective) or m[15]: ndc * w = m[0] x - m[2] depth + m[3], solved
  // for x. Orthographic lengths are in host units; a perspective's slopes have no unit.
  const double w = perspective ? -m[14] : m[15], unit = perspective ? 1 : metres_per_unit;
  const double shift_x = perspective ? m[2] : -m[3], shift_y = perspective ? m[6] : -m[7];
  const double first_x = 2 * (0.5 - jitter_px[0]) / width - 1,
               first_y = 2 * (0.5 - jitter_px[1]) / height - 1;
  return PixelRays{.scale_x = unit * 2 * w / (width * m[0]),
                   .offset_x = unit * (first_x * w + shift_x) / m[0],
                   .scale_y = unit * 2 * w / (height * m[5]),
                   .offset_y = unit * (first_y * w + shift_y) / m[5],
                   .perspective = perspective};
}

Matrix4 multiply(const Matrix4& a, const Matrix4& b) {
  Matrix4 product{};
  for (size_t r = 0; r < 4; ++r)
    for (size_t c = 0; c < 4; ++c)
      for (size_t k = 0; k < 4; ++k)
        product[4 * r + c] += a[4 * r + k] * b[4 * k + c];
  return product;
}

std::optional<Matrix4> invert_affine(const Matrix4& m) {
  if (m[12] != 0 || m[13] != 0 || m[14] != 0 || m[15] != 1) return std::nullopt;
  const auto cofactor = [&](size_t r, size_t c) {
    const size_t r1 = (r + 1) % 3, r2 = (r + 2) % 3, c1 = (c + 1) % 3, c2 = (c + 2) % 3;
    return m[4 * r1 + c1] * m[4 * r2 + c2] - m[4 * r1 + c2] * m[4 * r2 + c1];
  };
  const double determinant = m[0] * cofactor(0, 0) + m[1] * cofactor(0, 1) + m[2] * cofactor(0, 2);
  if (!std::isfinite(1 / determinant)) return std::nullopt;
  Matrix4 inverse{};
  for (size_t r = 0; r < 3; ++r)
    for (size_t c = 0; c < 3; ++c) {
      inverse[4 * r + c] = cofactor(c, r) / determinant;
      inverse[4 * r + 3] -= inverse[4 * r + c] * m[4 * c + 3];
    }
  inverse[15] = 1;
  return inverse;
}

DepthDecode depth_decode(const Matrix4& m, double metres_per_unit) {
  // value = (-m[10] depth + m[11]) / (-m[14] depth + m[15]), solved for depth.
  return {.a = -m[15] * metres_per_unit, .b = m[11] * metres_per_unit, .c = -m[14], .e = m[10]};
}

PixelRays orthographic_rays(uint32_t width, uint32_t height, double pitch_m) {
  return {.scale_x = pitch_m,
          .offset_x = (0.5 - 0.5 * width) * pitch_m,
          .scale_y = -pitch_m,
          .offset_y = (0.5 * height - 0.5) * pitch_m,
          .perspective = false};
}

} // namespace dermis::subsurface
