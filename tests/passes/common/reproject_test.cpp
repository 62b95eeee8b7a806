// Tests reprojection to the previous frame against known motions: camera turns, walks and zooms,
// moving objects, and changing rectangles.
#include "passes/common/reproject.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace dermis::subsurface {
namespace {

using Point = std::array<double, 3>;

Matrix4 lens(double scale, double aspect) {
  return {scale / aspect, 0, 0, 0, 0, -scale, 0, 0, 0, 0, 0, 0.1, 0, 0, -1, 0};
}
// Builds a camera at `place` (metres), turned by `angle` about y: view = R (world - place).
Matrix4 camera(const Point& place, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {c,  0, s, -(c * place[0] + s * place[2]), 0, 1, 0, -place[1],
          -s, 0, c, s * place[0] - c * place[2],    0, 0, 0, 1};
}
Point transform(const Matrix4& m, const Point& p) {
  Point out{};
  for (size_t r = 0; r < 3; ++r)
    out[r] = m[4 * r] * p[0] + m[4 * r + 1] * p[1] + m[4 * r + 2] * p[2] + m[4 * r + 3];
  return out;
}

struct View {
  Matrix4 view_from_world = camera({0, 0, 1}, 0);
  uint32_t x = 0, y = 0, width = 320, height = 180;
  double zoom = 3;
  std::array<double, 2> jitter{};
  bool parallel = false; // rays

  Matrix4 clip() const {
    Matrix4 m = lens(zoom, double(width) / height);
    if (parallel) {
      m[11] = m[15] = 1; // depth from 0 to 10 m, and w = 1
      m[10] = 0.1;
      m[14] = 0;
    }
    return m;
  }
  Matrix4 clip_with_jitter() const {
    Matrix4 m = clip();
    m[2] -= 2 * jitter[0] / width; // w = -z
    m[6] -= 2 * jitter[1] / height;
    return m;
  }
  // Returns the pixel of the rectangle (integers are centres) and the view depth in mm.
  PreviousPosition see(const Point& world, bool steady = false) const {
    const Point p = transform(view_from_world, world);
    const Matrix4 m = clip();
    const double px = ((m[0] * p[0]) / -p[2] * 0.5 + 0.5) * width - 0.5 + (steady ? 0 : jitter[0]);
    const double py = ((m[5] * p[1]) / -p[2] * 0.5 + 0.5) * height - 0.5 + (steady ? 0 : jitter[1]);
    return {px, py, -p[2] * 1000};
  }
};

FrameConstants constants_of(const View& now, const View& before) {
  FrameInput input;
  input.rect_x = now.x;
  input.rect_y = now.y;
  input.rect_width = now.width;
  input.rect_height = now.height;
  input.camera.clip_from_view = now.clip();
  input.jitter_px = now.jitter;
  input.camera.view_from_world = now.view_from_world;
  input.previous_x = before.x;
  input.previous_y = before.y;
  input.previous_width = before.width;
  input.previous_height = before.height;
  input.camera.previous_clip_from_view = before.clip_with_jitter();
  input.camera.previous_view_from_world = before.view_from_world;
  input.previous_jitter_px = before.jitter;
  FrameConstants constants{};
  EXPECT_TRUE(fill_frame_constants(input, constants));
  return constants;
}

// Returns points on a face-sized cap in front of the camera.
const std::vector<Point>& points() {
  static const std::vector<Point> all = [] {
    std::vector<Point> made;
    for (double x = -0.12; x <= 0.12; x += 0.03)
      for (double y = -0.07; y <= 0.07; y += 0.02)
        made.push_back({x, y, 0.1 - 3 * (x * x + y * y)});
    return made;
  }();
  return all;
}

// fp32 constants: a few ulp of 1000 mm over 0.3 mm per pixel.
constexpr double px_tolerance = 2e-3, depth_tolerance_mm = 1e-3;

void expect_places(const View& now, const View& before, const char* what) {
  const FrameConstants constants = constants_of(now, before);
  EXPECT_TRUE(history_usable(constants)) << what;
  for (const Point& point : points()) {
    const PreviousPosition here = now.see(point), there = before.see(point);
    const PreviousPosition found = reproject(constants, here.x, here.y, here.depth);
    ASSERT_NEAR(found.x, there.x, px_tolerance) << what;
    ASSERT_NEAR(found.y, there.y, px_tolerance) << what;
    ASSERT_NEAR(found.depth, there.depth, depth_tolerance_mm) << what;
  }
}

TEST(Reproject, CameraMotionIsInverted) {
  const View before;
  View now = before;
  now.view_from_world = camera({0.01, -0.004, 1}, 0);
  expect_places(now, before, "pan");
  now.view_from_world = camera({0, 0, 0.9}, 0);
  expect_places(now, before, "dolly");
  now.view_from_world = camera({0, 0, 1}, 0.03);
  expect_places(now, before, "turn");
  now.view_from_world = camera({0.05, 0.01, 1.02}, -0.06);
  expect_places(now, before, "all at once");
  now = before;
  now.zoom = 3.3;
  expect_places(now, before, "zoom");
}

TEST(Reproject, JitterOfBothFramesIsRemoved) {
  View before, now;
  before.jitter = {0.25, -0.5};
  now.jitter = {-0.125, 0.375};
  expect_places(now, before, "jitter");
}

TEST(Reproject, OtherRectangleSize_UsesItsOwnPixels) {
  View before, now;
  before.width = 240;
  before.height = 135;
  before.x = 8;
  now.x = 16;
  expect_places(now, before, "dynamic resolution");
  const FrameConstants constants = constants_of(now, before);
  EXPECT_EQ(constants.previous_rect[0], 8);
  // A velocity is in pixels of the current rectangle.
  for (const Point& point : points()) {
    const PreviousPosition here = now.see(point), there = before.see(point);
    const PreviousPosition found = reproject(constants, here.x, here.y, here.depth, {0, 0, 0});
    ASSERT_NEAR(found.x, there.x, px_tolerance);
    ASSERT_NEAR(found.y, there.y, px_tolerance);
  }
}

TEST(Reproject, MovingObjectIsFoundByItsVelocity) {
  View before, now;
  now.view_from_world = camera({0.01, 0, 0.98}, 0.01);
  before.jitter = {0.25, 0.125};
  now.jitter = {-0.25, 0};
  const FrameConstants constants = constants_of(now, before);
  const Point moved = {0.006, -0.003, 0.05}; // Metres since the previous frame.
  for (const Point& point : points()) {
    const Point earlier = {point[0] - moved[0], point[1] - moved[1], point[2] - moved[2]};
    const PreviousPosition here = now.see(point), there = before.see(earlier);
    const PreviousPosition here_steady = now.see(point, true),
                           there_steady = before.see(earlier, true);
    const PreviousPosition still = reproject(constants, here.x, here.y, here.depth);
    const double own_z = (still.depth - there.depth) / 1000; // World units are metres.
    const PreviousPosition found =
        reproject(constants, here.x, here.y, here.depth,
                  {here_steady.x - there_steady.x, here_steady.y - there_steady.y, own_z});
    ASSERT_NEAR(found.x, there.x, px_tolerance);
    ASSERT_NEAR(found.y, there.y, px_tolerance);
    ASSERT_NEAR(found.depth, there.depth, depth_tolerance_mm);
  }
}

TEST(Reproject, CameraAtRest_FindsEachPixelExactly) {
  View view;
  view.view_from_world = camera({0.013, 0.21, 1.7}, 0.37);
  const FrameConstants constants = constants_of(view, view);
  for (int y = 0; y < 180; y += 7)
    for (int x = 0; x < 320; x += 7) {
      const PreviousPosition found = reproject(constants, x, y, 700 + x + y);
      ASSERT_EQ(found.x, x);
      ASSERT_EQ(found.y, y);
      const HistoryTaps taps = find_history(constants, found, 1, depth_tolerance(constants, 700, 0),
                                            [&](int tx, int ty) {
                                              return SurfaceBefore{double(700 + tx + ty), 1};
                                            });
      ASSERT_EQ(taps.weight[0], 1) << x << " " << y; // No other pixel contributes.
    }
}

TEST(Reproject, TapsOfOtherSurfacesAreRejected) {
  const FrameConstants constants = constants_of({}, {});
  const PreviousPosition place{100.25, 50.5, 800};
  const auto taps_where = [&](const std::function<SurfaceBefore(int, int)>& at) {
    return find_history(constants, place, 3, depth_tolerance(constants, place.depth, 0), at);
  };
  const HistoryTaps all = taps_where([](int, int) { return SurfaceBefore{800, 3}; });
  EXPECT_NEAR(all.weight[0], 0.75 * 0.5, 1e-12);
  EXPECT_NEAR(all.weight[1], 0.25 * 0.5, 1e-12);
  // 2 % of 800 mm.
  for (const auto& [depth, valid] :
       {std::pair{815.9, true}, {816.1, false}, {784.1, true}, {783.9, false}}) {
    const HistoryTaps taps = taps_where([&, d = depth](int x, int) {
      return SurfaceBefore{x == 100 ? 800 : d, 3};
    });
    EXPECT_NEAR(taps.weight[0], valid ? 0.375 : 0.5, 1e-12) << depth;
    EXPECT_NEAR(taps.weight[0] + taps.weight[1] + taps.weight[2] + taps.weight[3], 1, 1e-12)
        << depth;
  }
  const HistoryTaps other = taps_where([](int x, int) {
    return SurfaceBefore{800, x == 100 ? 3u : 4u};
  });
  EXPECT_EQ(other.weight[1], 0);
  EXPECT_NEAR(other.weight[2], 0.5, 1e-12);
  // Only half of the column with a quarter of the weight is left: an eighth is too little.
  const HistoryTaps lost = taps_where([](int x, int y) {
    return SurfaceBefore{x == 101 && y == 50 ? 800.0 : 0.0, 3};
  });
  for (const double weight : lost.weight)
    EXPECT_EQ(weight, 0);
}

TEST(Reproject, SlopeWidensTheTolerance) {
  const FrameConstants constants = constants_of({}, {});
  EXPECT_EQ(depth_tolerance(constants, 500, 0), 10);
  EXPECT_EQ(depth_tolerance(constants, 500, 20), 40);
}

TEST(Reproject, ParallelRays_ToleranceIsInPixelsAndCoversRounding) {
  View parallel;
  parallel.parallel = true;
  const FrameConstants constants = constants_of({}, parallel);
  const double pixel = 2000 / parallel.zoom / parallel.height; // mm
  EXPECT_NEAR(depth_tolerance(constants, 0, 0), 8 * pixel, 1e-6);
  EXPECT_EQ(depth_tolerance(constants, 500, 20), 40);
  for (const double depth : {500.0, 5'001.0, 50'003.0}) {
    EXPECT_LT(depth_tolerance(constants, depth, 0), 8 * pixel + 0.002 * depth);
    for (double z = depth; z < 1.1 * depth; z += 0.7) { // kept as a half, which a driver truncates
      const double step = std::ldexp(1.0, std::ilogb(z) - 10);
      ASSERT_LT(z - step * std::floor(z / step), depth_tolerance(constants, z, 0)) << z;
    }
  }
}

TEST(Reproject, OutsideOrBehindTheCamera_HasNoHistory) {
  const FrameConstants constants = constants_of({}, {});
  const auto never = [](int x, int y) {
    EXPECT_TRUE(x >= 0 && y >= 0 && x < 320 && y < 180) << x << " " << y;
    return SurfaceBefore{800, 1};
  };
  // A tenth of a tap.
  EXPECT_EQ(find_history(constants, {-0.9, 10, 800}, 1, 16, never).weight[1], 0);
  EXPECT_EQ(find_history(constants, {-0.5, 10, 800}, 1, 16, never).weight[1], 1);
  EXPECT_EQ(find_history(constants, {319.75, 10, 800}, 1, 16, never).weight[0], 1);
  View before;
  before.view_from_world = camera({0, 0, -1}, 0); // All points are behind the camera.
  const FrameConstants behind = constants_of({}, before);
  EXPECT_EQ(reproject(behind, 160, 90, 900).depth, 0);
  EXPECT_EQ(find_history(behind, reproject(behind, 160, 90, 900), 1, 16, never).weight[0], 0);
}

TEST(Reproject, NaNOrHugeVelocity_HasNoHistory) {
  const FrameConstants constants = constants_of({}, {});
  const double nan = std::numeric_limits<double>::quiet_NaN(),
               inf = std::numeric_limits<double>::infinity();
  for (const std::array<double, 3>& velocity :
       {std::array{nan, 0.0, 0.0}, {0.0, inf, 0.0}, {1e30, 0.0, 0.0}, {0.0, 0.0, nan}}) {
    const PreviousPosition place = reproject(constants, 100, 50, 800, velocity);
    EXPECT_EQ(place.depth, 0);
    const HistoryTaps taps = find_history(constants, place, 1, 16, [](int, int) {
      return SurfaceBefore{800, 1};
    });
    EXPECT_EQ(taps.weight[0], 0);
  }
}

TEST(Reproject, FirstFrameAndCut_HaveNoHistory) {
  FrameInput input;
  input.rect_width = 320;
  input.rect_height = 180;
  input.camera.clip_from_view = input.camera.previous_clip_from_view = lens(3, 16.0 / 9);
  input.camera.view_from_world = input.camera.previous_view_from_world = camera({0, 0, 1}, 0);
  FrameConstants constants{};
  ASSERT_TRUE(fill_frame_constants(input, constants));
  EXPECT_FALSE(history_usable(constants)); // No previous rectangle.
  input.previous_width = 320;
  input.previous_height = 180;
  ASSERT_TRUE(fill_frame_constants(input, constants));
  EXPECT_TRUE(history_usable(constants));
  input.history_invalid = true; // A cut.
  ASSERT_TRUE(fill_frame_constants(input, constants));
  EXPECT_FALSE(history_usable(constants));
  input.history_invalid = false;
  input.camera.previous_clip_from_view = {}; // The host gives no previous camera.
  ASSERT_TRUE(fill_frame_constants(input, constants));
  EXPECT_FALSE(history_usable(constants));
  input.camera.previous_clip_from_view = input.camera.clip_from_view;
  input.camera.view_from_world = {}; // A degenerate matrix.
  ASSERT_TRUE(fill_frame_constants(input, constants));
  EXPECT_FALSE(history_usable(constants));
}

} // namespace
} // namespace dermis::subsurface
