#include "integration/tools/references/analytic.hpp"
#include "passes/common/profiles/burley_profile.hpp"
#include "passes/common/reference/planar.hpp"
#include "passes/common/reference/reference.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <set>

namespace dermis::subsurface {
namespace {

// A view of one plane with one profile; each test changes light, depth and profile.
struct Seen {
  uint32_t width, height;
  PixelRays rays;
  std::vector<float> light, depth, scale;
  std::vector<uint8_t> profile;
  std::vector<PerChannel> d;

  Seen(uint32_t w, uint32_t h, PerChannel d_m)
      : width(w), height(h), rays(orthographic_rays(w, h, 1e-3)), light(3 * w * h, 1.0f),
        depth(w * h, 0.5f), profile(w * h, 1), d{{0, 0, 0}, d_m} {}

  ReferenceInput input() const { return {width, height, rays, light, depth, profile, scale, d}; }
  size_t at(uint32_t x, uint32_t y) const { return size_t{y} * width + x; }
  void paint(const std::function<float(uint32_t, uint32_t)>& value) {
    for (uint32_t y = 0; y < height; ++y)
      for (uint32_t x = 0; x < width; ++x)
        for (size_t c = 0; c < 3; ++c)
          light[3 * at(x, y) + c] = value(x, y);
  }
};

float noise(uint32_t x, uint32_t y) { // Deterministic, in [0, 1).
  uint32_t h = x * 0x9e3779b9u ^ (y + 0x7f4a7c15u) * 0x85ebca6bu;
  h ^= h >> 15;
  h *= 0x2c1b3c6du;
  h ^= h >> 13;
  return float(h >> 8) / 16777216.0f;
}

TEST(Reference, ConstantLightStaysConstant) {
  Seen view(48, 40, {2e-3, 1e-3, 0.2e-3});
  view.profile[view.at(20, 20)] = 0; // Holes have no effect.
  for (const bool planar : {true, false})
    for (const double value : reference_everywhere(view.input(), {.planar_shortcut = planar}))
      EXPECT_NEAR(value, 1, 1e-12);
}

TEST(Reference, BlackStaysBlackAndNothingIsNegative) {
  Seen view(48, 40, {2e-3, 1e-3, 0.2e-3});
  for (const bool planar : {true, false}) {
    view.paint([](uint32_t, uint32_t) { return 0.0f; });
    for (const double value : reference_everywhere(view.input(), {.planar_shortcut = planar}))
      EXPECT_EQ(value, 0);
    view.paint([](uint32_t x, uint32_t) { return x < 2 ? 1e5f : 0.0f; });
    for (const double value : reference_everywhere(view.input(), {.planar_shortcut = planar}))
      EXPECT_GE(value, 0);
  }
}

TEST(Reference, ZeroDistanceReturnsTheLightBitForBit) {
  Seen view(16, 16, {0, 1e-3, 0});
  view.paint(noise);
  for (const bool planar : {true, false}) {
    const auto result = reference_everywhere(view.input(), {.planar_shortcut = planar});
    for (size_t i = 0; i < 256; ++i) {
      EXPECT_EQ(result[3 * i], double(view.light[3 * i]));
      EXPECT_NE(result[3 * i + 1], double(view.light[3 * i + 1]));
      EXPECT_EQ(result[3 * i + 2], double(view.light[3 * i + 2]));
    }
  }
}

TEST(Reference, VanishingDistanceConvergesToTheLight) {
  Seen view(16, 16,
            // Pixels are 1e-3 m: the fraction beyond 0.5 px is 0.75 e^-16 = 8e-8 for the first.
            {1e-5, 1e-7, 1e-30});
  view.paint(noise);
  const auto result = reference_everywhere(view.input(), {.planar_shortcut = false});
  for (size_t i = 0; i < result.size(); ++i)
    EXPECT_NEAR(result[i], double(view.light[i]), 1e-6);
}

TEST(Reference, HalfPlaneFollowsTheExactEdge) {
  // d = 4 px. Difference to the closed form of the plane: the cut at 20 d omits 0.75 e^(-20/3) =
  // 9.5e-4 of the energy, all of it on one side. Pixels beyond 4 px, sampled at their centre, add a
  // few 1e-5.
  Seen view(340, 190, {4e-3, 2e-3, 1e-3});
  view.paint([](uint32_t x, uint32_t) { return x < 170 ? 0.0f : 1.0f; });
  std::vector<uint32_t> row;
  for (uint32_t x = 100; x < 240; ++x)
    row.push_back(95 * view.width + x);
  const auto result = reference_at(view.input(), row);
  for (size_t i = 0; i < row.size(); ++i)
    for (size_t c = 0; c < 3; ++c)
      EXPECT_NEAR(result[3 * i + c],
                  burley_edge(double(row[i] % 340) + 0.5 - 170, view.d[1][c] * 1e3), 1e-3)
          << row[i] % 340 << " " << c;
}

TEST(Reference, SinusoidContrastFollowsTheTransferFunction) {
  // d = 3 px, period 32 px: k d = 0.589. Light that is constant over pixels multiplies the contrast
  // by sinc(1/32) = 0.99839.
  Seen view(256, 128, {3e-3, 3e-3, 3e-3});
  const double pi = 3.14159265358979323846, k = 2 * pi / 32;
  view.paint([&](uint32_t x, uint32_t) { return float(0.5 + 0.5 * std::cos(k * x)); });
  const std::vector<uint32_t> peaks = {64 * 256 + 128, 64 * 256 + 112};
  const auto result = reference_at(view.input(), peaks);
  const double contrast = result[0] - result[3];
  // The cut at 20 d: 9.5e-4.
  EXPECT_NEAR(contrast, burley_mtf(k, 3) * std::sin(k / 2) / (k / 2), 1.5e-3);
}

TEST(Reference, FastAndGeneralPathsAgree) {
  Seen view(61, 53, {2.2e-3, 0.9e-3, 0.1e-3});
  view.paint(noise);
  for (uint32_t y = 0; y < 53; ++y)
    for (uint32_t x = 30; x < 61; ++x) {
      view.profile[view.at(x, y)] = x > 50 ? 0 : 2;
      view.depth[view.at(x, y)] = 0.7f;
    }
  view.d.push_back({1e-3, 3e-3, 0.0});
  ASSERT_TRUE(is_planar(view.input()));
  const auto fast = reference_everywhere(view.input(), {.planar_shortcut = true});
  const auto general = reference_everywhere(view.input(), {.planar_shortcut = false});
  for (size_t i = 0; i < fast.size(); ++i)
    ASSERT_NEAR(fast[i], general[i], 1e-12) << i;
}

TEST(Reference, OtherMaterialsDoNotLeakIn) {
  Seen view(64, 32, {3e-3, 3e-3, 3e-3});
  view.paint([](uint32_t x, uint32_t) { return x < 32 ? 1.0f : 0.0f; });
  for (uint32_t y = 0; y < 32; ++y)
    for (uint32_t x = 32; x < 64; ++x)
      view.profile[view.at(x, y)] = 2;
  view.d.push_back(view.d[1]);
  const auto result = reference_everywhere(view.input());
  for (uint32_t x = 0; x < 64; ++x)
    EXPECT_NEAR(result[3 * view.at(x, 16)], x < 32 ? 1 : 0, 1e-12);
}

TEST(Reference, FarStepsInDepthDoNotLeak) {
  Seen view(48, 24, {1e-3, 1e-3, 1e-3});
  for (uint32_t y = 0; y < 24; ++y)
    for (uint32_t x = 24; x < 48; ++x) {
      view.depth[view.at(x, y)] = 0.6f; // 100 d behind.
      for (size_t c = 0; c < 3; ++c)
        view.light[3 * view.at(x, y) + c] = 0;
    }
  const auto result = reference_everywhere(view.input());
  for (uint32_t x = 0; x < 48; ++x)
    EXPECT_NEAR(result[3 * view.at(x, 12)], x < 24 ? 1 : 0, 1e-12);
}

TEST(Reference, TiltedPlaneScattersInSurfaceDistance) {
  // Seen at 60 degrees, the surface is stretched by 2 along x; an edge must follow the closed form
  // in surface distance.
  Seen view(220, 160, {4e-3, 4e-3, 4e-3});
  for (uint32_t y = 0; y < view.height; ++y)
    for (uint32_t x = 0; x < view.width; ++x)
      view.depth[view.at(x, y)] = float(0.5 + x * 1e-3 * std::sqrt(3.0));
  view.paint([](uint32_t x, uint32_t) { return x < 110 ? 0.0f : 1.0f; });
  std::vector<uint32_t> row;
  for (uint32_t x = 80; x < 140; ++x)
    row.push_back(80 * view.width + x);
  const auto result = reference_at(view.input(), row);
  for (size_t i = 0; i < row.size(); ++i)
    // Tolerance: 1e-3 for the cut at 20 d, and 5e-4 because patches 2 px long beyond 4 px are
    // sampled at their centre.
    EXPECT_NEAR(result[3 * i], burley_edge(2 * (double(row[i] % 220) + 0.5 - 110), 4), 1.5e-3)
        << row[i] % 220;
}

TEST(Reference, PerspectiveAndOrthographicViewsOfOnePlaneAgree) {
  // A plane at 0.5 m with 1 mm pixels: rays of 2e-3 per pixel. Patches come from rays of one eye,
  // but their positions are equal.
  Seen ortho(40, 40, {2e-3, 1e-3, 0.5e-3});
  ortho.paint(noise);
  Seen eye = ortho;
  eye.rays.perspective = true;
  for (double* x : {&eye.rays.scale_x, &eye.rays.offset_x, &eye.rays.scale_y, &eye.rays.offset_y})
    *x *= 2;
  const auto a = reference_everywhere(ortho.input(), {.planar_shortcut = false}),
             b = reference_everywhere(eye.input());
  for (size_t i = 0; i < a.size(); ++i)
    ASSERT_NEAR(a[i], b[i], 1e-9) << i;
}

TEST(Reference, ScatterScaleActsOnTheReceivingPixel) {
  Seen view(32, 32, {2e-3, 1e-3, 0.5e-3});
  view.paint(noise);
  const auto full = reference_everywhere(view.input(), {.planar_shortcut = false});
  Seen half = view;
  for (double& x : half.d[1])
    x *= 0.5;
  const auto halved = reference_everywhere(half.input(), {.planar_shortcut = false});
  view.scale.assign(32 * 32, 1.0f);
  for (size_t i = 0; i < view.scale.size(); i += 3)
    view.scale[i] = i % 2 == 0 ? 0.5f : 0.0f;
  const auto mixed = reference_everywhere(view.input());
  for (size_t i = 0; i < view.scale.size(); ++i) {
    const double expected = view.scale[i] == 1     ? full[3 * i]
                            : view.scale[i] == 0.5 ? halved[3 * i]
                                                   : double(view.light[3 * i]);
    EXPECT_NEAR(mixed[3 * i], expected, 1e-14);
  }
}

TEST(Reference, PixelsWithoutSurfaceKeepTheirLight) {
  Seen view(16, 16, {2e-3, 2e-3, 2e-3});
  view.paint(noise);
  view.depth[5] = 0;
  view.depth[6] = INFINITY;
  view.depth[7] = NAN;
  view.profile[8] = 0;
  view.profile[9] = 77; // No such profile: d = 0.
  for (const bool planar : {true, false}) {
    const auto result = reference_everywhere(view.input(), {.planar_shortcut = planar});
    for (size_t i = 5; i < 10; ++i)
      EXPECT_EQ(result[3 * i], double(view.light[3 * i])) << i;
    for (const double value : result)
      EXPECT_TRUE(value >= 0 && value <= 1);
  }
}

TEST(Reference, GrazingPatches_AreaIsCapped) {
  Seen view(8, 8, {2e-3, 2e-3, 2e-3});
  for (uint32_t y = 0; y < 8; ++y)
    for (uint32_t x = 0; x < 8; ++x) // Each axis is below the cap, both together are above.
      view.depth[view.at(x, y)] = 0.5f + 6e-3f * float(x + y);
  const Surface surface = build_surface(8, 8, view.rays, view.depth, view.profile, 1);
  for (const Patch& patch : surface.patches)
    EXPECT_NEAR(patch.area, 1e-6 / min_patch_cosine, 1e-12);
}

// The slope of the cap is 6.591 pixel sides. A patch below the cap keeps its normal; a patch just
// above, with neighbours within the cap on each axis, is tilted back to the cap, so its plane rises
// no further. Along an axis beyond the cap no neighbour belongs to the patch.
TEST(Reference, GrazingPatches_TiltIsCapped) {
  struct Case {
    double slope_x, slope_y, tilt;
  };
  for (const Case& one : {Case{6, 0, 6}, Case{0, 6.58, 6.58}, Case{4, 4, std::hypot(4, 4)},
                          Case{6.58, 1, max_patch_slope}, Case{5, -6, max_patch_slope},
                          Case{6.6, 0, 0}, Case{0, 100, 0}, Case{2, 7, 2}}) {
    Seen view(8, 8, {2e-3, 2e-3, 2e-3});
    for (uint32_t y = 0; y < 8; ++y)
      for (uint32_t x = 0; x < 8; ++x)
        view.depth[view.at(x, y)] =
            static_cast<float>(0.9 + 1e-3 * (one.slope_x * x + one.slope_y * y));
    const Surface surface = build_surface(8, 8, view.rays, view.depth, view.profile, 1);
    // Depths are floats: the error of a step of 1e-3 m at 1 m is up to 6e-8 / 1e-3 per pixel.
    for (const Patch& patch : surface.patches) {
      const double tilt = std::hypot(patch.normal[0], patch.normal[1]) / patch.normal[2];
      EXPECT_NEAR(tilt, one.tilt, 5e-4) << one.slope_x << " " << one.slope_y;
    }
  }
}

// Returns the tilt of a patch along both axes: change of depth in metres per metre across the view.
std::array<double, 2> tilt_of(const Patch& patch) {
  return {patch.normal[0] / patch.normal[2], patch.normal[1] / patch.normal[2]};
}

TEST(Reference, IsolatedPixels_PatchesLieAcrossTheView) {
  Seen view(9, 9, {2e-3, 2e-3, 2e-3});
  for (uint32_t y = 0; y < 9; ++y)
    for (uint32_t x = 0; x < 9; ++x) // Alternates between two planes 5 cm apart.
      view.depth[view.at(x, y)] = (x + y) % 2 == 0 ? 0.5f : 0.55f;
  const Surface surface = build_surface(9, 9, view.rays, view.depth, view.profile, 1);
  for (const Patch& patch : surface.patches)
    EXPECT_NEAR(patch.area, 1e-6, 1e-12);
}

TEST(Reference, NeighbourOnAnotherSurface_OtherSideCounts) {
  // A plane with slope 1 ends at column 4; beyond it lies another surface.
  Seen view(8, 8, {2e-3, 2e-3, 2e-3});
  for (const float other : {0.2f, 0.9f}) {
    for (uint32_t y = 0; y < 8; ++y)
      for (uint32_t x = 0; x < 8; ++x)
        view.depth[view.at(x, y)] = x <= 4 ? 0.5f + 1e-3f * float(x) : other;
    const Surface surface = build_surface(8, 8, view.rays, view.depth, view.profile, 1);
    for (uint32_t x = 0; x < 8; ++x) {
      const auto [tilt_x, tilt_y] = tilt_of(surface.patches[view.at(x, 3)]);
      EXPECT_NEAR(tilt_x, x <= 4 ? 1 : 0, 1e-3) << x;
      EXPECT_NEAR(tilt_y, 0, 1e-6) << x;
    }
  }
}

TEST(Reference, PatchNeighbours_AreMeasuredInSidesOfTheirAxis) {
  // Pixels of 1 mm x 4 mm. Steps of 10 mm are 10 sides along a row and 2.5 along a column.
  for (const bool perspective : {false, true}) {
    Seen view(8, 8, {2e-3, 2e-3, 2e-3});
    const double distance = perspective ? 20 : 1;
    view.rays = {1e-3 / distance, -3.5e-3 / distance, -4e-3 / distance, 14e-3 / distance,
                 perspective};
    for (const bool down : {false, true}) {
      for (uint32_t y = 0; y < 8; ++y)
        for (uint32_t x = 0; x < 8; ++x)
          view.depth[view.at(x, y)] = static_cast<float>(distance + 10e-3 * (down ? y : x));
      const Surface surface = build_surface(8, 8, view.rays, view.depth, view.profile, 1);
      const auto [tilt_x, tilt_y] = tilt_of(surface.patches[view.at(3, 3)]);
      EXPECT_NEAR(std::abs(tilt_x), 0, 2e-2) << perspective << down;
      EXPECT_NEAR(std::abs(tilt_y), down ? 2.5 : 0, 5e-2) << perspective << down;
    }
  }
}

TEST(Reference, ResultIsIndependentOfTheThreadCount) {
  Seen view(40, 30, {2e-3, 1e-3, 0.5e-3});
  view.paint(noise);
  for (const bool planar : {true, false})
    EXPECT_EQ(reference_everywhere(view.input(), {.threads = 1, .planar_shortcut = planar}),
              reference_everywhere(view.input(), {.threads = 3, .planar_shortcut = planar}));
}

TEST(Reference, KernelOfAPixelGridSumsToTheCdf) {
  // A pixel beyond 4 px is sampled at its centre, where 1/r is below the pixel's mean by a fraction
  // of 1 / (24 r^2). The radial density is at most e^(-r / (3 d)) / (2 d) per pixel, so the lost
  // energy is at most e^(-4 / (3 d)) / (48 * 4 * d), 1.4e-3 at d = 1.33. The 8x8 points of nearer
  // pixels lose another 2e-4.
  for (const double d : {0.05, 0.3, 1.0, 2.0}) {
    double sum = 0;
    for (int64_t y = -40; y <= 40; ++y)
      for (int64_t x = -40; x <= 40; ++x)
        sum += planar_weight(1, 1, x, y, {d, d, d})[0];
    const double cut = std::min(40.5, reference_radius_in_d * d);
    EXPECT_GT(sum, burley_cdf(cut, d) - 1.6e-3) << d;
    EXPECT_LT(sum, 1 + 2e-4) << d;
  }
}

TEST(Reference, SubsetIsStratifiedSortedAndRepeatable) {
  std::vector<uint8_t> profile(64 * 64, 0);
  for (size_t i = 0; i < profile.size(); ++i)
    profile[i] = i % 3 == 0;
  const auto subset = stratified_subset(64, 64, profile, 100);
  EXPECT_EQ(subset.size(), 100u);
  EXPECT_EQ(subset, stratified_subset(64, 64, profile, 100));
  EXPECT_NE(subset, stratified_subset(64, 64, profile, 100, 2));
  EXPECT_EQ(std::set<uint32_t>(subset.begin(), subset.end()).size(), 100u);
  for (const uint32_t i : subset)
    EXPECT_EQ(profile[i], 1);
  std::vector<int> quarters(4);
  for (const uint32_t i : subset)
    ++quarters[i / 1024];
  for (const int n : quarters)
    EXPECT_NEAR(n, 25, 2); // Strata follow rows of tiles.
  EXPECT_EQ(stratified_subset(64, 64, profile, 1u << 20).size(), 1366u);
}

} // namespace
} // namespace dermis::subsurface
