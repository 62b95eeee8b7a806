// The surface-aware pyramid on pixels that are not square.
#include "tests/passes/sap/cpu/sap_cpu.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace dermis::subsurface {
namespace {

SapShape shape_of(double aspect, double bias = pixel_doubling_bias) {
  const double octaves = std::abs(std::log2(aspect));
  const auto halvings = static_cast<uint32_t>(octaves + bias);
  return {.halvings = halvings, .log2_aspect = octaves - halvings};
}

enum class Relief : uint8_t { plane, tilt, bumps, step, perspective };

// Pixels of 1 mm2 with an aspect; light and surface depend on the position in metres only.
struct ShapedScene {
  static constexpr uint32_t width = 120, height = 90;
  double aspect;
  PixelRays rays = orthographic_rays(width, height, 1);
  std::vector<float> light{}, depth{};
  std::vector<uint8_t> profile = std::vector<uint8_t>(size_t{width} * height, 1);
  std::vector<PerChannel> d;

  ShapedScene(Relief surface, double pixel_aspect, double d_px)
      : aspect(pixel_aspect), d{{0, 0, 0}, {d_px * 1e-3, d_px * 1e-3, d_px * 1e-3}} {
    const double side_x = 1e-3 * std::sqrt(aspect), side_y = 1e-3 / std::sqrt(aspect);
    rays.scale_x *= side_x;
    rays.offset_x *= side_x;
    rays.scale_y *= side_y;
    rays.offset_y *= side_y;
    rays.perspective = surface == Relief::perspective;
    for (uint32_t j = 0; j < height; ++j)
      for (uint32_t i = 0; i < width; ++i) {
        const double x = (i + 0.5 - width / 2.0) * side_x, y = (j + 0.5 - height / 2.0) * side_y;
        light.insert(light.end(), 3, light_at(x, y));
        depth.push_back(static_cast<float>(depth_at(surface, x, y)));
      }
  }
  static float light_at(double x, double y) {
    const auto checks = [&](double size, double turn) {
      const double u = x * std::cos(turn) + y * std::sin(turn),
                   v = y * std::cos(turn) - x * std::sin(turn);
      return std::abs(std::fmod(std::floor(u / size) + std::floor(v / size), 2.0));
    };
    return static_cast<float>(0.1 + 0.4 * checks(0.0171, 0.3) + 0.3 * checks(0.0047, 1.1) +
                              0.2 * checks(0.0013, 2.0));
  }
  static double depth_at(Relief surface, double x, double y) {
    if (surface == Relief::tilt) return 1 + 0.9 * x + 0.6 * y;
    if (surface == Relief::step) return 0.8 * x + 0.6 * y > 0.004 ? 1.03 : 1;
    if (surface == Relief::plane) return 1;
    return 1 + 0.006 * std::sin(x / 0.012) * std::cos(y / 0.015);
  }
  ReferenceInput input() const { return {width, height, rays, light, depth, profile, {}, d}; }
  std::vector<float> scatter(const SapShape& shape, SapVariant variant = SapVariant::smooth) const {
    const auto table = make_sap_table(fit_sap_weights(variant, burley_shape(1), shape));
    return sap_scatter<float>(input(), table, {.variant = variant, .grid = {shape, aspect < 1}})
        .light;
  }
};

double rmse(const ShapedScene& scene, const std::vector<float>& light) {
  const auto pixels =
      stratified_subset(ShapedScene::width, ShapedScene::height, scene.profile, 400);
  const auto reference = reference_at(scene.input(), pixels);
  double squares = 0;
  for (size_t i = 0; i < pixels.size(); ++i)
    squares += std::pow(double(light[size_t{3} * pixels[i]]) - reference[3 * i], 2);
  return std::sqrt(squares / double(pixels.size()));
}

// Returns the geometric mean over surfaces, in dB.
double mean_error_db(double aspect, SapVariant variant, const SapShape& shape) {
  double sum = 0;
  for (const Relief surface :
       {Relief::plane, Relief::tilt, Relief::bumps, Relief::step, Relief::perspective}) {
    const ShapedScene scene(surface, aspect, 4);
    sum += 20 * std::log10(rmse(scene, scene.scatter(shape, variant))) / 5;
  }
  return sum;
}

TEST(SapShape, ErrorStaysNearThatOfSquarePixels) {
  const double square = mean_error_db(1, SapVariant::smooth, {});
  const struct {
    double aspect, limit_db;
  } cases[] = {{4.0 / 3, 4}, {0.75, 4}, {2, 4}, {0.5, 4}, {4, 6}, {0.25, 6}};
  for (const auto& [aspect, limit_db] : cases) {
    const double more = mean_error_db(aspect, SapVariant::smooth, shape_of(aspect)) - square;
    RecordProperty("aspect_" + std::to_string(aspect), std::to_string(more));
    EXPECT_LE(more, limit_db) << aspect;
  }
}

TEST(SapShape, BaseIsNoWorseThanWithSquares) {
  for (const double aspect : {4.0 / 3, 0.5, 4.0})
    EXPECT_LE(mean_error_db(aspect, SapVariant::base, shape_of(aspect)),
              mean_error_db(aspect, SapVariant::base, {}))
        << aspect;
}

TEST(SapShape, ASweepOfTheAspectHasNoSteps) {
  // At the doubling, the plan changes; elsewhere only the weights and the tents do.
  const double doubling = std::exp2(1 - pixel_doubling_bias);
  const ShapedScene scene(Relief::bumps, doubling, 4);
  const std::vector<float> fewer = scene.scatter(shape_of(doubling, 0)),
                           more = scene.scatter(shape_of(doubling, 0.5));
  double squares = 0;
  for (size_t i = 0; i < fewer.size(); ++i)
    squares += std::pow(double(fewer[i] - more[i]), 2);
  EXPECT_LE(std::sqrt(squares / double(fewer.size())), 0.01);
}

TEST(SapShape, TentsOfSquarePixelsAreBinomial) {
  for (uint32_t level = 0; level < sap_level_count; ++level)
    EXPECT_EQ(SapShape{}.tent(level % 2, level), (std::array<double, 3>{0.5, 0.25, 0}));
}

TEST(SapShape, LevelsAreAsWideAlongBothAxes) {
  for (const double aspect : {1.2, 1.45, 2.0, 3.7}) {
    const SapShape shape = shape_of(aspect);
    for (uint32_t level = 0; level < sap_first_short_tent; ++level) {
      std::array<double, 2> variance{};
      for (const uint32_t axis : {0u, 1u}) {
        const double spacing = shape.spacing(axis, level), side = shape.side(axis);
        const auto tent = shape.tent(axis, level);
        EXPECT_NEAR(tent[0] + 2 * tent[1] + 2 * tent[2], 1, 1e-12);
        for (uint32_t l = 1; l <= level; ++l)
          if (shape.halves(axis, l))
            variance[axis] += 1.5 * std::pow(shape.spacing(axis, l - 1) * side, 2);
        variance[axis] += 2 * (tent[1] + 4 * tent[2]) * std::pow(spacing * side, 2);
      }
      EXPECT_NEAR(variance[0], variance[1], 1e-9 * variance[0]) << aspect << " level " << level;
    }
  }
}

TEST(SapShape, ConstantLightStaysConstant) {
  ShapedScene scene(Relief::bumps, 2.3, 8);
  std::fill(scene.light.begin(), scene.light.end(), 0.7f);
  for (const float value : scene.scatter(shape_of(2.3)))
    ASSERT_NEAR(value, 0.7f, 1e-6);
}

} // namespace
} // namespace dermis::subsurface
