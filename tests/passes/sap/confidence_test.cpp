// Tests what the confidence of the surface-aware pyramid means: it is high on surfaces that the
// pyramid represents, whatever is missing around them, and an upper bound of the error falls with
// it.
#include "tests/passes/sap/confidence_scenes.hpp"
#include "tests/passes/sap/cpu/sap_cpu.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace dermis::subsurface {
namespace {

using confidence_scenes::height, confidence_scenes::width;

struct Arrays {
  std::vector<float> light, depth;
  std::vector<uint8_t> profile;
  std::vector<PerChannel> d;
  PixelRays rays = orthographic_rays(width, height, 1e-3);

  explicit Arrays(const confidence_scenes::Scene& scene)
      : d{{0, 0, 0}, PerChannel{scene.d_px, scene.d_px, scene.d_px}} {
    for (double& channel : d[1])
      channel *= 1e-3;
    d.push_back(d[1]);
    for (uint32_t y = 0; y < height; ++y)
      for (uint32_t x = 0; x < width; ++x) {
        light.insert(light.end(), 3, confidence_scenes::light(x, y));
        depth.push_back(scene.depth_m(int(x), int(y)));
        profile.push_back(scene.profile(int(x), int(y)));
      }
  }
  ReferenceInput input() const { return {width, height, rays, light, depth, profile, {}, d}; }
};

SapResult<float> scattered(const Arrays& arrays) {
  static const std::vector<float> table = make_sap_table(fit_sap_weights(SapVariant::smooth));
  return sap_scatter<float>(arrays.input(), table, {});
}

TEST(SapConfidence, RepresentedSurface_IsSure) {
  for (const auto& scene : confidence_scenes::all()) {
    const Arrays arrays(scene);
    const std::vector<float> confidence = scattered(arrays).confidence;
    const float lowest = *std::min_element(confidence.begin(), confidence.end());
    RecordProperty(scene.name, std::to_string(lowest));
    if (scene.represented)
      EXPECT_GT(lowest, 0.985f) << scene.name;
    else
      EXPECT_LT(lowest, 0.85f) << scene.name; // Measured at most 0.845 (grooves).
    EXPECT_GE(lowest, 0) << scene.name;
    EXPECT_LE(*std::max_element(confidence.begin(), confidence.end()), 1 + 1e-6f) << scene.name;
  }
}

TEST(SapConfidence, ErrorFallsWithConfidence) {
  // The last bin has the sure pixels. Nearly no pixel lies between 0.95 and 0.985.
  constexpr std::array<double, 5> bounds = {0.3, 0.5, 0.8, 0.985, 2};
  std::array<double, bounds.size()> squares{}, counts{}, rmse{};
  for (const auto& scene : confidence_scenes::all()) {
    const Arrays arrays(scene);
    const SapResult<float> result = scattered(arrays);
    std::vector<uint32_t> pixels;
    for (uint32_t i = 0; i < arrays.profile.size(); i += 5) // 5 is coprime to the width.
      if (arrays.profile[i] != 0) pixels.push_back(i);
    const std::vector<double> reference = reference_at(arrays.input(), pixels);
    for (size_t k = 0; k < pixels.size(); ++k) {
      const double error = double(result.light[3 * size_t{pixels[k]}]) - reference[3 * k];
      size_t bin = 0;
      while (double(result.confidence[pixels[k]]) >= bounds[bin])
        ++bin;
      squares[bin] += error * error;
      counts[bin] += 1;
    }
  }
  for (size_t i = 0; i < bounds.size(); ++i) {
    ASSERT_GT(counts[i], 0) << bounds[i];
    rmse[i] = std::sqrt(squares[i] / counts[i]);
    std::printf("confidence below %.3f: %5.0f pixels, RMSE %.2fe-3\n", bounds[i], counts[i],
                1e3 * rmse[i]);
  }
  // Regression bounds: 10 % above the measured errors.
  constexpr std::array<double, bounds.size()> max_rmse = {12.1e-3, 5.5e-3, 5.0e-3, 1.6e-3, 1.9e-3};
  for (size_t i = 0; i < bounds.size(); ++i)
    EXPECT_LT(rmse[i], max_rmse[i]) << bounds[i];
  // Pixels above 0.8 have as little error as sure ones.
  EXPECT_GT(rmse[0], 1.5 * rmse[2]);
  EXPECT_GT(rmse[1], 2.5 * rmse[4]);
  EXPECT_GT(rmse[2], 2.5 * std::max(rmse[3], rmse[4]));
}

} // namespace
} // namespace dermis::subsurface
