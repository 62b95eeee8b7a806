#include "passes/common/camera.hpp"

#include <gtest/gtest.h>

#include <array>
#include <limits>

namespace dermis::subsurface {
namespace {

// Vulkan clip space, y down, reversed depth with the far plane at infinity: value = near / depth.
Matrix4 perspective(double scale_x, double scale_y, double centre_x, double near) {
  return {scale_x, 0, centre_x, 0, 0, -scale_y, 0, 0, 0, 0, 0, near, 0, 0, -1, 0};
}

// Projects a view-space point: returns pixel coordinates (integers are centres) without jitter, and
// the depth value.
std::array<double, 3> project(const Matrix4& m, std::array<double, 3> p, double width,
                              double height) {
  std::array<double, 4> clip{};
  for (size_t r = 0; r < 4; ++r)
    clip[r] = m[4 * r] * p[0] + m[4 * r + 1] * p[1] + m[4 * r + 2] * p[2] + m[4 * r + 3];
  return {(clip[0] / clip[3] * 0.5 + 0.5) * width - 0.5,
          (clip[1] / clip[3] * 0.5 + 0.5) * height - 0.5, clip[2] / clip[3]};
}

TEST(Camera, PerspectiveRaysInvertTheProjection) {
  const Matrix4 m = perspective(1.7, 2.3, 0.11, 0.1);
  const auto rays = pixel_rays(m, 64, 48, 0.01, {0, 0});
  ASSERT_TRUE(rays.has_value());
  EXPECT_TRUE(rays->perspective);
  const double depth = 3.5, i = 17, j = 29;
  const std::array<double, 3> point = {(rays->scale_x * i + rays->offset_x) * depth,
                                       (rays->scale_y * j + rays->offset_y) * depth, -depth};
  const auto seen = project(m, point, 64, 48);
  EXPECT_NEAR(seen[0], i, 1e-12);
  EXPECT_NEAR(seen[1], j, 1e-12);
  const DepthDecode decode = depth_decode(m, 1);
  EXPECT_NEAR((decode.a * seen[2] + decode.b) / (decode.c * seen[2] + decode.e), depth, 1e-12);
}

TEST(Camera, OrthographicRaysInvertTheProjection) {
  const Matrix4 m = {0.2, 0, 0, 0.3, 0, -0.25, 0, 0.1, 0, 0, -0.02, 0.05, 0, 0, 0, 1};
  const auto rays = pixel_rays(m, 10, 20, 0.01, {0, 0}); // Host units are centimetres.
  ASSERT_TRUE(rays.has_value());
  EXPECT_FALSE(rays->perspective);
  const double i = 3, j = 12, z = 7;
  const std::array<double, 3> point = {(rays->scale_x * i + rays->offset_x) * 100,
                                       (rays->scale_y * j + rays->offset_y) * 100, -z};
  const auto seen = project(m, point, 10, 20);
  EXPECT_NEAR(seen[0], i, 1e-12);
  EXPECT_NEAR(seen[1], j, 1e-12);
  const DepthDecode decode = depth_decode(m, 0.01);
  EXPECT_NEAR((decode.a * seen[2] + decode.b) / (decode.c * seen[2] + decode.e), 0.01 * z, 1e-12);
}

TEST(Camera, JitterMovesThePixelRays) {
  const Matrix4 m = perspective(1, 1, 0, 0.1);
  const auto still = pixel_rays(m, 32, 32, 1, {0, 0}),
             moved = pixel_rays(m, 32, 32, 1, {0.25, -0.5});
  // The picture moved right by a quarter, so pixel i shows the former position i - 0.25.
  EXPECT_NEAR(moved->offset_x, still->offset_x - 0.25 * still->scale_x, 1e-15);
  EXPECT_NEAR(moved->offset_y, still->offset_y + 0.5 * still->scale_y, 1e-15);
}

TEST(Camera, RowsGoDownWhileYGoesUp) {
  EXPECT_LT(pixel_rays(perspective(1, 1, 0, 0.1), 32, 32, 1, {0, 0})->scale_y, 0);
  const PixelRays ortho = orthographic_rays(4, 2, 0.5);
  EXPECT_EQ(ortho.offset_x, -0.75);
  EXPECT_EQ(ortho.offset_y, 0.25);
  EXPECT_EQ(ortho.scale_y, -0.5);
}

Matrix4 transposed(const Matrix4& m) {
  Matrix4 t{};
  for (size_t r = 0; r < 4; ++r)
    for (size_t c = 0; c < 4; ++c)
      t[4 * c + r] = m[4 * r + c];
  return t;
}

// Half of all engines store matrices by columns, and a perspective on its side looks like a
// perspective with another field of view.
TEST(Camera, ColumnMajorMatrix_IsRejected) {
  const Matrix4 forward{2, 0, 0.1, 0, 0, -2, 0, 0, 0, 0, -1, -0.1, 0, 0, -1, 0};
  const Matrix4 reversed{2, 0, 0, 0, 0, -2, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0}; // Near plane at 1 unit.
  const Matrix4 flat{2, 0, 0, 0.5, 0, -2, 0, 0, 0, 0, -0.1, -0.1, 0, 0, 0, 1};
  for (const Matrix4& right : {forward, reversed, flat})
    for (const bool left : {false, true}) {
      const Matrix4 m = left ? with_mirrored_view(right) : right;
      std::optional<Handedness> declared;
      if (left) declared = Handedness::left;
      Handedness found = Handedness::right;
      CameraMatrices stored{m, m, m, m}, on_its_side{transposed(m), m, m, m};
      EXPECT_EQ(to_right_handed(stored, declared, found), CameraFault::none);
      EXPECT_EQ(found, left ? Handedness::left : Handedness::right);
      EXPECT_TRUE(pixel_rays(stored.clip_from_view, 64, 64, 1, {0, 0}));
      if (transposed(m) != m) {
        EXPECT_EQ(to_right_handed(on_its_side, std::nullopt, found),
                  CameraFault::stored_by_columns);
      }
    }
}

// The matrices of one camera in both view spaces give equal results, and errors name the
// contradiction.
TEST(Camera, AcceptsBothHandednesses) {
  const Matrix4 perspective_now = perspective(1.7, 2.3, 0.11, 0.1),
                flat{2, 0, 0, 0.5, 0, -2, 0, 0, 0, 0, 0.1, 1, 0, 0, 0, 1};
  const Matrix4 view{0.8, 0, -0.6, 1, 0, 1, 0, 2, 0.6, 0, 0.8, -3, 0, 0, 0, 1};
  const Matrix4 mirrored_view{0.8, 0, -0.6, 1, 0, 1, 0, 2, -0.6, 0, -0.8, 3, 0, 0, 0, 1};
  for (const Matrix4& clip : {perspective_now, flat}) {
    const CameraMatrices right{clip, view, clip, view};
    CameraMatrices same = right, left{with_mirrored_view(clip), mirrored_view,
                                      with_mirrored_view(clip), mirrored_view};
    Handedness found = Handedness::left;
    EXPECT_EQ(to_right_handed(same, std::nullopt, found), CameraFault::none);
    EXPECT_EQ(found, Handedness::right);
    EXPECT_EQ(to_right_handed(left, Handedness::left, found), CameraFault::none);
    EXPECT_EQ(found, Handedness::left);
    for (const CameraMatrices* one : {&same, &left}) {
      EXPECT_EQ(one->clip_from_view, right.clip_from_view);
      EXPECT_EQ(one->view_from_world, right.view_from_world);
      EXPECT_EQ(one->previous_clip_from_view, right.previous_clip_from_view);
      EXPECT_EQ(one->previous_view_from_world, right.previous_view_from_world);
    }
  }
  const auto fault = [&](const Matrix4& now, const Matrix4& before,
                         std::optional<Handedness> declared) {
    CameraMatrices camera{now, view, before, view};
    const CameraMatrices kept = camera;
    Handedness found = Handedness::right;
    const CameraFault result = to_right_handed(camera, declared, found);
    EXPECT_EQ(camera.clip_from_view, kept.clip_from_view) << "a fault changes nothing";
    return result;
  };
  const Matrix4 left_now = with_mirrored_view(perspective_now),
                left_flat = with_mirrored_view(flat);
  EXPECT_EQ(fault(perspective_now, {}, Handedness::left), CameraFault::declared_left);
  EXPECT_EQ(fault(left_now, {}, Handedness::right), CameraFault::declared_right);
  EXPECT_EQ(fault(left_now, perspective_now, std::nullopt), CameraFault::previous_right);
  EXPECT_EQ(fault(perspective_now, left_now, std::nullopt), CameraFault::previous_left);
  EXPECT_EQ(fault(flat, left_now, std::nullopt), CameraFault::previous_left);
  EXPECT_EQ(fault(left_flat, perspective_now, Handedness::left), CameraFault::previous_right);
  EXPECT_EQ(fault(left_flat, {}, std::nullopt), CameraFault::behind_camera);
  EXPECT_EQ(fault(flat, {}, Handedness::left), CameraFault::behind_camera);
  EXPECT_EQ(fault(perspective_now, left_flat, std::nullopt), CameraFault::previous_behind_camera);
  EXPECT_EQ(fault({}, {}, std::nullopt), CameraFault::no_projection);
  for (int i = 1; i <= static_cast<int>(CameraFault::previous_behind_camera); ++i)
    EXPECT_FALSE(text_of(static_cast<CameraFault>(i)).empty()) << i;
}

TEST(Camera, NotAnAxisAlignedProjection_IsRejected) {
  const Matrix4 good = perspective(1, 1, 0, 0.1);
  Matrix4 m = good;
  m[1] = 0.1; // Sheared.
  EXPECT_FALSE(pixel_rays(m, 8, 8, 1, {0, 0}));
  m = good;
  m[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(pixel_rays(m, 8, 8, 1, {0, 0}));
  m = good;
  m[14] = 1; // Left-handed.
  EXPECT_FALSE(pixel_rays(m, 8, 8, 1, {0, 0}));
  m = good;
  m[0] = 0;
  EXPECT_FALSE(pixel_rays(m, 8, 8, 1, {0, 0}));
  EXPECT_FALSE(pixel_rays(good, 0, 8, 1, {0, 0}));
  EXPECT_FALSE(pixel_rays(good, 8, 8, 0, {0, 0}));
  EXPECT_TRUE(pixel_rays(good, 8, 8, 1, {0, 0}));
}

} // namespace
} // namespace dermis::subsurface
