#include "passes/common/camera.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace dermis::subsurface {

namespace {

enum class Projection : uint8_t {
  none,
  stored_by_columns,
  right_perspective,
  left_perspective,
  orthographic
};

bool is_finite(const Matrix4& m) {
  return std::all_of(m.begin(), m.end(), [](double x) { return std::isfinite(x); });
}

// The w row of a perspective projection is 0 0 -1 0, or 0 0 1 0 if view space is left-handed; that
// of an orthographic projection is 0 0 0 1. If the last column has these values instead, the matrix
// is transposed.
bool stored_by_columns(const Matrix4& m) {
  if (std::abs(m[11]) == 1 && m[15] == 0) return std::abs(m[14]) != 1;
  const bool last_column_empty = m[3] == 0 && m[7] == 0 && m[11] == 0;
  return last_column_empty && m[15] == 1 && (m[12] != 0 || m[13] != 0 || m[14] != 0);
}

// Rows x, y and w may depend only on their own axis, on z (off-centre perspective) and on 1
// (off-centre orthographic projection).
Projection projection_of(const Matrix4& m) {
  if (!is_finite(m) || m[1] != 0 || m[4] != 0 || m[0] == 0 || m[5] == 0) return Projection::none;
  const bool perspective =
      m[12] == 0 && m[13] == 0 && m[14] != 0 && m[15] == 0 && m[3] == 0 && m[7] == 0;
  const bool orthographic =
      m[12] == 0 && m[13] == 0 && m[14] == 0 && m[15] > 0 && m[2] == 0 && m[6] == 0;
  if ((perspective || !orthographic) && stored_by_columns(m)) return Projection::stored_by_columns;
  if (perspective) return m[14] < 0 ? Projection::right_perspective : Projection::left_perspective;
  return orthographic ? Projection::orthographic : Projection::none;
}

// Returns whether the whole depth range is behind the camera. A far plane at infinity is on neither
// side. `m` must have a right-handed view space.
bool shows_what_is_behind(const Matrix4& m) {
  const DepthDecode decode = depth_decode(m, 1);
  const double ends[] = {decode.b / decode.e, (decode.a + decode.b) / (decode.c + decode.e)};
  const auto behind = [](double depth) { return std::isinf(depth) || depth <= 0; };
  const auto surely_behind = [](double depth) { return std::isfinite(depth) && depth < 0; };
  return std::all_of(std::begin(ends), std::end(ends), behind) &&
         std::any_of(std::begin(ends), std::end(ends), surely_behind);
}

// Returns the matrix for the same view space with the other handedness.
Matrix4 with_mirrored_rows(const Matrix4& view_from_world) {
  Matrix4 m = view_from_world;
  for (size_t c = 0; c < 4; ++c)
    m[8 + c] = -m[8 + c];
  return m;
}

} // namespace

Matrix4 with_mirrored_view(const Matrix4& clip_from_view) {
  Matrix4 m = clip_from_view;
  for (size_t r = 0; r < 4; ++r)
    m[4 * r + 2] = -m[4 * r + 2];
  return m;
}

CameraFault to_right_handed(CameraMatrices& matrices, std::optional<Handedness> declared,
                            Handedness& found) {
  const Projection now = projection_of(matrices.clip_from_view);
  const Projection before = projection_of(matrices.previous_clip_from_view);
  if (now == Projection::none) return CameraFault::no_projection;
  if (now == Projection::stored_by_columns) return CameraFault::stored_by_columns;
  if (now == Projection::right_perspective && declared == Handedness::left)
    return CameraFault::declared_left;
  if (now == Projection::left_perspective && declared == Handedness::right)
    return CameraFault::declared_right;
  const bool left = now == Projection::left_perspective ||
                    (now == Projection::orthographic && declared == Handedness::left);
  CameraMatrices right = matrices;
  if (left)
    right = {with_mirrored_view(matrices.clip_from_view),
             with_mirrored_rows(matrices.view_from_world),
             with_mirrored_view(matrices.previous_clip_from_view),
             with_mirrored_rows(matrices.previous_view_from_world)};
  // A near plane at 1 unit can look like a w row.
  if (shows_what_is_behind(right.clip_from_view))
    return now != Projection::orthographic && std::abs(matrices.clip_from_view[11]) == 1
               ? CameraFault::stored_by_columns
               : CameraFault::behind_camera;
  if (left && before == Projection::right_perspective) return CameraFault::previous_right;
  if (!left && before == Projection::left_perspective) return CameraFault::previous_left;
  const bool judged = before == Projection::orthographic ||
                      before == Projection::right_perspective ||
                      before == Projection::left_perspective;
  if (judged && shows_what_is_behind(right.previous_clip_from_view))
    return CameraFault::previous_behind_camera;
  matrices = right;
  found = left ? Handedness::left : Handedness::right;
  return CameraFault::none;
}

std::string_view text_of(CameraFault fault) {
  switch (fault) {
  case CameraFault::none:
    break;
  case CameraFault::no_projection:
    return "clip_from_view (without the jitter) is not an axis-aligned perspective or orthographic "
           "projection with finite elements";
  case CameraFault::no_depth:
    return "clip_from_view maps all points to one depth: elements 8 to 11 are its depth row";
  case CameraFault::stored_by_columns:
    return "clip_from_view is not a projection because it is stored column by column; store row r, "
           "column c "
           "in element [r * 4 + c]";
  case CameraFault::declared_left:
    return "view space is declared left-handed, but clip_from_view has w = -z, which is "
           "right-handed";
  case CameraFault::declared_right:
    return "view space is declared right-handed, but clip_from_view has w = z, which is "
           "left-handed";
  case CameraFault::previous_right:
    return "the frame is left-handed, but previous_clip_from_view has w = -z, which is "
           "right-handed";
  case CameraFault::previous_left:
    return "the frame is right-handed, but previous_clip_from_view has w = z, which is left-handed";
  case CameraFault::behind_camera:
    return "clip_from_view maps only points behind the camera to depth 0..1";
  case CameraFault::previous_behind_camera:
    return "previous_clip_from_view maps only points behind the camera to depth 0..1";
  }
  return "";
}

std::optional<PixelRays> pixel_rays(const Matrix4& m, uint32_t width, uint32_t height,
                                    double metres_per_unit, std::array<double, 2> jitter_px) {
  if (!std::isfinite(jitter_px[0]) || !std::isfinite(jitter_px[1]) || width == 0 || height == 0 ||
      !(metres_per_unit > 0) || !std::isfinite(metres_per_unit))
    return std::nullopt;
  const Projection projection = projection_of(m);
  if (projection != Projection::right_perspective && projection != Projection::orthographic)
    return std::nullopt;
  const bool perspective = projection == Projection::right_perspective;

  // The matrix is row-major, and view z is -depth. Row 0 gives ndc_x * clip_w = m[0] * x - m[2] *
  // depth + m[3], with clip_w = -m[14] * depth (perspective) or m[15] (orthographic). Solved for x,
  // the view-space position (orthographic, host units), or for x / depth (perspective, no unit).
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
  // Solves value = (-m[10] depth + m[11]) / (-m[14] depth + m[15]) for depth.
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
