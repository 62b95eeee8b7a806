#include "integration/tools/files/metrics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace dermis::tools {
namespace {

TEST(Metrics, ConstantErrorIsItsRmse) {
  const std::vector<float> image(3 * 100, 1.5f);
  const std::vector<double> reference(3 * 100, 1.4);
  std::vector<uint32_t> pixels(100);
  std::iota(pixels.begin(), pixels.end(), 0u);
  const ErrorFigures figures = measure_error(image, reference, pixels, 0.5, 100);
  EXPECT_NEAR(figures.rmse, 0.05, 1e-8);
  EXPECT_NEAR(figures.psnr_db, 26.0206, 1e-4);
  EXPECT_NEAR(figures.max_error, 0.05, 1e-8);
  EXPECT_NEAR(figures.p99_error, 0.05, 1e-8);
  EXPECT_NEAR(figures.rmse_rgb[2], 0.05, 1e-8);
  EXPECT_EQ(figures.rmse_low, figures.rmse);
}

TEST(Metrics, LuminanceWeighsTheChannels) {
  const std::vector<float> image = {1, 0, 0};
  const std::vector<double> reference = {0, 0, 0};
  const std::vector<uint32_t> pixels = {0};
  const ErrorFigures figures = measure_error(image, reference, pixels, 1, 1);
  EXPECT_NEAR(figures.rmse, 0.2126, 1e-12);
  EXPECT_EQ(figures.rmse_rgb[0], 1);
}

TEST(Metrics, OnlyListedPixelsCount) {
  const std::vector<float> image = {9, 9, 9, 1, 1, 1, 9, 9, 9};
  const std::vector<double> reference = {1, 1, 1};
  const std::vector<uint32_t> pixels = {1};
  EXPECT_EQ(measure_error(image, reference, pixels, 1, 3).rmse, 0);
  EXPECT_EQ(measure_error(image, reference, pixels, 1, 3).psnr_db, max_psnr_db);
}

TEST(Metrics, P99IsTheNearestRank) {
  std::vector<float> image(3 * 200);
  std::vector<uint32_t> pixels(200);
  for (uint32_t i = 0; i < 200; ++i) {
    pixels[i] = i;
    image[3 * i] = image[3 * i + 1] = image[3 * i + 2] = float(i);
  }
  const ErrorFigures figures = measure_error(image, std::vector<double>(600), pixels, 1, 200);
  EXPECT_NEAR(figures.p99_error, 197, 1e-9); // The 198th of 200.
  EXPECT_NEAR(figures.max_error, 199, 1e-9);
}

TEST(Metrics, NonFiniteResultsAreInfiniteErrors) {
  const std::vector<float> image = {NAN, 0, 0};
  const std::vector<double> reference = {0, 0, 0};
  const std::vector<uint32_t> pixels = {0};
  const ErrorFigures figures = measure_error(image, reference, pixels, 1, 1);
  EXPECT_TRUE(std::isinf(figures.rmse));
  EXPECT_TRUE(std::isinf(figures.max_error));
  EXPECT_LT(figures.psnr_db, 0);
}

TEST(Metrics, ConfidenceIntervalContainsTheFullValue) {
  // 400 subsets of 100 out of 10000: 95 % of the intervals must contain the reference. The binomial
  // sd is 1.1 %, and the mean of 100 squares of a uniform error is close to normal.
  std::vector<float> image(30000);
  uint32_t state = 1;
  auto random = [&] { return state = state * 1664525u + 1013904223u, state >> 8; };
  for (size_t i = 0; i < 10000; ++i)
    image[3 * i] = image[3 * i + 1] = image[3 * i + 2] = float(random()) / 16777216.0f;
  std::vector<uint32_t> all(10000);
  std::iota(all.begin(), all.end(), 0u);
  const double whole = measure_error(image, std::vector<double>(30000), all, 1, 10000).rmse;
  int held = 0;
  for (int run = 0; run < 400; ++run) {
    std::vector<uint32_t> pixels(100);
    for (uint32_t& p : pixels)
      p = random() % 10000;
    const ErrorFigures figures = measure_error(image, std::vector<double>(300), pixels, 1, 10000);
    held += figures.rmse_low <= whole && whole <= figures.rmse_high;
  }
  EXPECT_GE(held, 364); // 91 %: 3.5 sd
  EXPECT_LE(held, 396);
}

TEST(Metrics, ExposureMapsTheBrightEndToOne) {
  ExposureMeter meter;
  std::vector<float> light(3 * 1000);
  std::vector<uint8_t> profile(1000, 1);
  for (size_t i = 0; i < 1000; ++i)
    light[3 * i] = light[3 * i + 1] = light[3 * i + 2] = float(i + 1);
  profile[998] = 0; // 999 is left out, so 998 is among the brightest values.
  light[3 * 997] = NAN;
  meter.add(light, profile);
  EXPECT_NEAR(meter.result(), 1.0 / 1000, 1e-9); // Rank ceil(0.999 * 998) = 998 of 998 values.
  EXPECT_EQ(ExposureMeter{}.result(), 1);
}

TEST(Metrics, RoundingOfBlackIsNotExposed) {
  ExposureMeter black, faint;
  black.luminance = {5e-16f, -5e-16f, 1e-9f};
  EXPECT_EQ(black.result(), 1);
  faint.luminance = {1e-6f};
  EXPECT_NEAR(faint.result(), 1e6, 1);
}

} // namespace
} // namespace dermis::tools
