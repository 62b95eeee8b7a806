// Techniques on pixels that are not square, on the device.
#include "tests/framegraph/test_scale.hpp"
#include "tests/properties/plane.hpp"

#include "passes/common/reference/reference.hpp"
#include "tests/passes/sap/cpu/sap_cpu.hpp"

#include <algorithm>
#include <cmath>

namespace {

using namespace properties;
namespace subsurface = dermis::subsurface;

struct Technique {
  const char* name;
  const char* graph;
  Settings settings;
  bool full_only = false;
};
void PrintTo(const Technique& technique, std::ostream* out) {
  *out << technique.name;
}

// Squares and edges at several scales, in lengths: equal on every shape of pixels.
float pattern(double x_m, double y_m) {
  const auto checks = [&](double size) {
    return std::abs(std::fmod(std::floor(x_m / size) + std::floor(y_m / size), 2.0));
  };
  return float(0.1 + 0.5 * checks(0.0113) * checks(0.0031) + (x_m + 0.4 * y_m > 0.003 ? 0.3 : 0));
}

struct Scene {
  Plane plane{.width = 72, .height = 56};

  explicit Scene(double aspect) {
    plane.pixel_aspect = aspect;
    plane.light = [this](double x, double y) {
      return pattern((x - 35.5) * side_x(), (y - 27.5) * side_y());
    };
  }
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;
  double side_x() const { return plane.pixel_pitch_m * std::sqrt(plane.pixel_aspect); }
  double side_y() const { return plane.pixel_pitch_m / std::sqrt(plane.pixel_aspect); }

  std::vector<float> light{}, depth = std::vector<float>(size_t{72} * 56, 1.0f);
  std::vector<uint8_t> profile = std::vector<uint8_t>(size_t{72} * 56, 1);
  std::vector<subsurface::PerChannel> d{};

  subsurface::ReferenceInput input() {
    light.clear();
    for (uint32_t y = 0; y < plane.height; ++y)
      for (uint32_t x = 0; x < plane.width; ++x)
        light.insert(light.end(), 3, plane.light(x, y));
    d = {{0, 0, 0}, {}};
    for (size_t c = 0; c < 3; ++c)
      d[1][c] = plane.d_px[c] * plane.pixel_pitch_m;
    auto rays = subsurface::orthographic_rays(plane.width, plane.height, 1);
    rays.scale_x *= side_x();
    rays.offset_x *= side_x();
    rays.scale_y *= side_y();
    rays.offset_y *= side_y();
    return {plane.width, plane.height, rays, light, depth, profile, {}, d};
  }
};

class PixelShape : public DeviceTest, public ::testing::WithParamInterface<Technique> {
protected:
  void SetUp() override {
    if (GetParam().full_only) DERMIS_FULL_TESTS_ONLY();
    DeviceTest::SetUp();
  }
  double rmse(double aspect) {
    Scene scene(aspect);
    const Picture picture = run(GetParam().graph, scene.plane, GetParam().settings);
    const auto reference = subsurface::reference_everywhere(scene.input());
    double squares = 0;
    for (size_t i = 0; i < picture.rgb.size() && i < reference.size(); ++i)
      squares += std::pow(double(picture.rgb[i]) - reference[i], 2);
    return std::sqrt(squares / double(reference.size()));
  }
};

INSTANTIATE_TEST_SUITE_P(Techniques, PixelShape,
                         ::testing::Values(Technique{"sap", "sap", {}},
                                           Technique{"pyramid", "pyramid", {}},
                                           Technique{"separable", "separable", {}},
                                           Technique{"burley", "burley", {}, true},
                                           Technique{"fixed", "fixed", {}, true},
                                           Technique{"afis", "afis", {}, true},
                                           Technique{"afis_published", "afis_published", {}, true},
                                           Technique{"hybrid", "hybrid", {}, true}),
                         [](const auto& one) { return std::string(one.param.name); });

TEST_P(PixelShape, ErrorIsAtMostTwiceThatOfSquares) {
  const double square = rmse(1);
  for (const double aspect : {2.0, 0.5}) {
    const double error = rmse(aspect);
    RecordProperty(aspect > 1 ? "wide" : "high", std::to_string(error / square));
    EXPECT_LE(error, 2 * square) << aspect;
  }
}

class SapPixelShape : public DeviceTest {};

TEST_F(SapPixelShape, DeviceMatchesTheCpu) {
  for (const double aspect : dermis::testing::seeds_to_try(0, 1) != 0
                                 ? std::vector{2.0, 4.0 / 3, 0.25}
                                 : std::vector{2.0}) {
    Scene scene(aspect);
    const Picture picture = run("sap", scene.plane, {});
    const double octaves = std::abs(std::log2(aspect));
    const dermis::PixelGrid grid = dermis::pixel_grid(aspect);
    const uint32_t halvings =
        std::max(dermis::pixel_doublings(grid, 0), dermis::pixel_doublings(grid, 1));
    const subsurface::SapShape shape{.halvings = halvings, .log2_aspect = octaves - halvings};
    const auto table = subsurface::make_sap_table(subsurface::fit_sap_weights(
        subsurface::SapVariant::smooth, subsurface::burley_shape(1), shape));
    const auto cpu =
        subsurface::sap_scatter<float>(scene.input(), table, {.grid = {shape, aspect < 1}});
    double worst = 0;
    for (size_t i = 0; i < cpu.light.size(); ++i)
      worst = std::max(worst, double(std::abs(cpu.light[i] - picture.rgb[i])));
    // Light has 11 bits, and weights between two tables are interpolated.
    EXPECT_LE(worst, 5e-3) << aspect;
  }
}

TEST_F(SapPixelShape, BothShapesOfKernelsGiveEqualBits) {
  for (const double aspect :
       dermis::testing::seeds_to_try(0, 1) != 0 ? std::vector{2.0, 0.75, 0.25} : std::vector{2.0}) {
    Scene scene(aspect);
    scene.plane.depth_m = [](int x, int y) {
      return 1.0f + 0.03f * static_cast<float>((x / 9 + y / 5) % 2);
    };
    scene.plane.kernels = demo::KernelShape::cpu;
    const Picture cpu = run("sap", scene.plane, {});
    scene.plane.kernels = demo::KernelShape::gpu;
    const Picture gpu = run("sap", scene.plane, {});
    EXPECT_EQ(gpu.rgb, cpu.rgb) << aspect;
  }
}

} // namespace
