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
  Settings settings = {};
  bool full_only = false;
  bool folded = false; // on a relief, where confidence is low
  uint32_t frames = 1;
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

  explicit Scene(double aspect, bool folded = false) {
    plane.pixel_aspect = aspect;
    plane.light = [this](double x, double y) { return mean_pattern(x, y); };
    if (folded)
      plane.depth_m = [this](int x, int y) {
        return float(1 + 0.004 * std::sin((x - 35.5) * side_x() / 0.003) *
                             std::cos((y - 27.5) * side_y() / 0.004));
      };
  }
  // Returns the mean over the pixel, which changes continuously with the shape of pixels.
  float mean_pattern(double x, double y) const {
    constexpr int parts = 4;
    float sum = 0;
    for (int i = 0; i < parts * parts; ++i) {
      const double right = (i % parts + 0.5) / parts - 0.5, down = (i / parts + 0.5) / parts - 0.5;
      sum += pattern((x - 35.5 + right) * side_x(), (y - 27.5 + down) * side_y());
    }
    return sum / (parts * parts);
  }
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;
  double side_x() const { return plane.pixel_pitch_m * std::sqrt(plane.pixel_aspect); }
  double side_y() const { return plane.pixel_pitch_m / std::sqrt(plane.pixel_aspect); }

  std::vector<float> light{}, depth{};
  std::vector<uint8_t> profile = std::vector<uint8_t>(size_t{72} * 56, 1);
  std::vector<subsurface::PerChannel> d{};

  subsurface::ReferenceInput input() {
    light.clear();
    depth.clear();
    for (uint32_t y = 0; y < plane.height; ++y)
      for (uint32_t x = 0; x < plane.width; ++x) {
        light.insert(light.end(), 3, plane.light(x, y));
        depth.push_back(plane.depth_m(int(x), int(y)));
      }
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

double root_mean_square(const std::vector<double>& values) {
  double squares = 0;
  for (const double value : values)
    squares += value * value;
  return std::sqrt(squares / double(values.size()));
}

std::vector<double> errors_of(const Picture& picture, Scene& scene) {
  const auto reference = subsurface::reference_everywhere(scene.input());
  std::vector<double> errors;
  for (size_t i = 0; i < picture.rgb.size() && i < reference.size(); ++i)
    errors.push_back(double(picture.rgb[i]) - reference[i]);
  return errors;
}

class PixelShape : public DeviceTest, public ::testing::WithParamInterface<Technique> {
protected:
  void SetUp() override {
    if (GetParam().full_only) DERMIS_FULL_TESTS_ONLY();
    DeviceTest::SetUp();
  }
  double rmse(double aspect) {
    Scene scene(aspect, GetParam().folded);
    Picture picture;
    run_frames(GetParam().graph, scene.plane, GetParam().settings, GetParam().frames,
               [&](const Picture& frame) { picture = frame; });
    return root_mean_square(errors_of(picture, scene));
  }
};

INSTANTIATE_TEST_SUITE_P(
    Techniques, PixelShape,
    ::testing::Values(Technique{"sap", "sap"}, Technique{"pyramid", "pyramid"},
                      Technique{"separable", "separable"},
                      Technique{"sap_residual", "sap_residual", {}, false, true, 16},
                      Technique{"sap_base", "sap", {{"variant", "\"base\""}}, true},
                      Technique{"sap_blend", "sap_blend", {}, true, true},
                      Technique{"hybrid", "hybrid", {}, true, true},
                      Technique{"hybrid_afis_separable", "hybrid_afis_separable", {}, true, true},
                      Technique{"burley", "burley", {}, true},
                      Technique{"fixed", "fixed", {}, true}, Technique{"afis", "afis", {}, true},
                      Technique{"afis_seed", "afis_seed", {}, true},
                      Technique{"afis_published", "afis_published", {}, true},
                      Technique{"afis_guided", "afis_guided", {}, true, false, 8}),
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

TEST_F(SapPixelShape, ErrorStaysNearThatOfSquares) {
  std::vector<double> aspects{1.1, 1.5, 2.4, 3.2};
  if (dermis::testing::seeds_to_try(0, 1) != 0) {
    aspects.clear();
    for (int i = 11; i <= 40; ++i)
      aspects.push_back(i / 10.0);
  }
  const auto decibels = [](double aspect) {
    Scene scene(aspect);
    return 20 * std::log10(root_mean_square(errors_of(run("sap", scene.plane, {}), scene)));
  };
  const double square = decibels(1);
  double sum = 0;
  for (const double aspect : aspects)
    sum += decibels(aspect) - square;
  RecordProperty("mean_db", std::to_string(sum / double(aspects.size())));
  EXPECT_LE(sum / double(aspects.size()), 8);
}

// The plan changes at 1.07 and 2^0.58, and weights of the other shapes are interpolated.
TEST_F(SapPixelShape, NoStepWhereShapesChange) {
  const auto errors = [](double aspect) {
    Scene scene(aspect);
    return errors_of(run("sap", scene.plane, {}), scene);
  };
  std::vector<std::pair<double, double>> steps{{1.065, 1.075}, {1.49, 1.5}};
  for (uint64_t i = 100; i < dermis::testing::seeds_to_try(100, 200); i += 5)
    steps.emplace_back(double(i) / 100, double(i + 1) / 100);
  for (const auto& [before, after] : steps) {
    std::vector<double> change = errors(after);
    const std::vector<double> old = errors(before);
    for (size_t i = 0; i < change.size(); ++i)
      change[i] -= old[i];
    RecordProperty("step_" + std::to_string(int(100 * after)),
                   std::to_string(root_mean_square(change)));
    EXPECT_LE(root_mean_square(change), 0.003) << after;
  }
}

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
