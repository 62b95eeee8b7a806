#include "passes/separable/separable_kernel.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace {

using namespace dermis::subsurface;

// The arithmetic of the shader's two passes, on a plane without borders (wrapping).
std::vector<double> run(const std::vector<double>& image, int size,
                        std::span<const SeparableRow> rows, uint32_t choice, double d_px,
                        int channel) {
  const uint32_t side = (separable_taps[choice] - 1) / 2;
  auto pass = [&](const std::vector<double>& in, bool vertical) {
    std::vector<double> out(in.size());
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x) {
        double sum = 0, total = 0;
        auto read = [&](int k, double w) {
          const int px = vertical ? x : ((x + k) % size + size) % size,
                    py = vertical ? ((y + k) % size + size) % size : y;
          sum += w * in[static_cast<size_t>(py * size + px)];
          total += w;
        };
        read(0, separable_row(rows, choice, d_px, 0)[static_cast<size_t>(channel)]);
        for (uint32_t i = 1; i <= side; ++i) {
          const SeparableRow tap = separable_row(rows, choice, d_px, i);
          const int below = static_cast<int>(tap[3]);
          const double part = tap[3] - below, w = tap[static_cast<size_t>(channel)];
          for (const int sign : {-1, 1}) {
            read(sign * below, w * (1 - part));
            read(sign * (below + 1), w * part);
          }
        }
        out[static_cast<size_t>(y * size + x)] = sum / total;
      }
    return out;
  };
  const std::vector<double> blurred = pass(pass(image, false), true);
  const double centre = separable_row(rows, choice, d_px, side + 1)[static_cast<size_t>(channel)];
  std::vector<double> result(image.size());
  for (size_t i = 0; i < image.size(); ++i)
    result[i] = centre * image[i] + (1 - centre) * blurred[i];
  return result;
}

TEST(SeparableKernel, WeightsAreNotNegativeAndSumToOneAtEveryNode) {
  for (const uint32_t taps : separable_taps)
    for (const double d : {0.0625, 0.3, 1.0, 5.0, 40.0, 181.0}) {
      const SeparableFit fit = fit_separable(d, separable_offsets(d, taps));
      double sum = fit.weights[0];
      for (size_t i = 1; i < fit.weights.size(); ++i) {
        EXPECT_GE(fit.weights[i], 0.0);
        sum += 2 * fit.weights[i];
      }
      EXPECT_NEAR(sum, 1.0, 1e-12);
      EXPECT_GE(fit.centre, 0.0);
      EXPECT_LE(fit.centre, 1.0);
    }
}

TEST(SeparableKernel, NoScattering_IsTheDelta) {
  const SeparableFit fit = fit_separable(0.0, separable_offsets(4.0, 25));
  EXPECT_EQ(fit.centre, 1.0);
  EXPECT_EQ(fit.weights[0], 1.0);
}

TEST(SeparableKernel, MoreTapsNeverIncreaseTheResidual) {
  for (const double d : {1.0, 4.0, 16.0}) {
    const double coarse = fit_separable(d, separable_offsets(d, 11)).residual;
    const double middle = fit_separable(d, separable_offsets(d, 17)).residual;
    const double fine = fit_separable(d, separable_offsets(d, 25)).residual;
    EXPECT_LT(middle, coarse) << d;
    EXPECT_LT(fine, middle) << d;
  }
}

TEST(SeparableKernel, ResidualIsBelowItsDocumentedBound) {
  // Documented in docs/techniques.md: relative to the change that scattering makes; 25 taps.
  for (const double d : {0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0})
    // Regression bound of the present implementation.
    EXPECT_LT(fit_separable(d, separable_offsets(d, 25)).residual, 0.05) << d;
}

TEST(SeparableKernel, ReferenceTransferHasTheProfilesMoments) {
  // Var per axis = E[r^2] / 2 + pixel box = 7 d^2 + 1/12 (E[r^2] = 14 d^2); transfer = 1 - 2 pi^2
  // f^2 Var + O(f^4 d^4). Sampling at whole pixels adds aliases below 1e-3 of the moment from d = 2
  // px on.
  for (const double d : {2.0, 8.0}) {
    EXPECT_NEAR(pixel_kernel_transfer(d, 0, 0), 1.0, 1e-12);
    const double f = 1e-4 / d;
    const double curvature = (1 - pixel_kernel_transfer(d, f, 0)) / (2 * M_PI * M_PI * f * f);
    EXPECT_NEAR(curvature / (7 * d * d + 1.0 / 12), 1.0, 1e-3) << d;
  }
}

TEST(SeparableKernel, TableMatchesTheFitAtNodesAndBetween) {
  const std::vector<SeparableRow> rows = make_separable_rows({1.0, 0.4, 0.0});
  ASSERT_EQ(rows.size(), separable_rows_per_profile);
  const double node_d = 4.0;
  const SeparableFit fit = fit_separable(node_d, separable_offsets(node_d, 17));
  for (uint32_t i = 0; i <= 8; ++i)
    EXPECT_NEAR(separable_row(rows, 1, node_d, i)[0], fit.weights[i], 1e-6);
  for (uint32_t i = 0; i <= 8; ++i) // A channel without scattering.
    EXPECT_EQ(separable_row(rows, 1, node_d, i)[2], i == 0 ? 1.0f : 0.0f);
  EXPECT_EQ(separable_row(rows, 1, node_d, 9)[2], 1.0f);
}

TEST(SeparableKernel, FlatLightStaysFlatAndEnergyIsKept) {
  constexpr int size = 64;
  const std::vector<SeparableRow> rows = make_separable_rows({1.0, 0.38, 0.19});
  std::vector<double> spot(size * size, 0.0);
  spot[size * size / 2 + size / 2] = 1.0;
  for (uint32_t choice = 0; choice < 3; ++choice)
    for (const double d : {0.7, 1.9, 3.3}) {
      const std::vector<double> flat =
          run(std::vector<double>(size * size, 1.0), size, rows, choice, d, 1);
      EXPECT_NEAR(flat[17], 1.0, 1e-6);
      double sum = 0;
      for (const double x : run(spot, size, rows, choice, d, 0))
        sum += x;
      EXPECT_NEAR(sum, 1.0, 1e-5);
    }
}

} // namespace
