#include "passes/separable/separable_kernel.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <span>
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

TEST(SeparableKernel, ReachCoversEveryTap) {
  const std::vector<SeparableRow> rows = make_separable_rows({1, 0.5, 0.25});
  for (uint32_t choice = 0; choice < 3; ++choice) {
    const uint32_t taps = separable_taps[choice], side = (taps - 1) / 2;
    for (double d = 0.06; d < 180; d *= 1.01)
      for (const double other : {0.97 * d, d, 1.03 * d}) { // whose kernel the pixel may have
        const double offset = separable_row(rows, choice, other, side)[3];
        const int farthest = static_cast<int>(std::max(offset, offset * d / other)) + 1;
        EXPECT_LE(farthest, separable_reach_px(d, taps)) << taps << " taps, d " << d << " px";
      }
  }
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
    EXPECT_LT(fit_separable(d, separable_offsets(d, 25)).residual, 0.051) << d;
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

// Rows of the node of a d for one choice of taps.
std::span<const SeparableRow> node_rows(std::span<const SeparableRow> rows, uint32_t choice,
                                        uint32_t node) {
  size_t first = 0;
  for (uint32_t i = 0; i < choice; ++i)
    first += size_t{separable_nodes} * separable_rows_per_node(separable_taps[i]);
  const uint32_t per_node = separable_rows_per_node(separable_taps[choice]);
  return rows.subspan(first + size_t{node} * per_node, per_node);
}

TEST(SeparableKernel, DenseTaps_HaveOffsetsOfWholePixels) {
  const std::vector<SeparableRow> rows = make_separable_rows({1.0, 0.38, 0.19});
  constexpr uint32_t choice = 2, taps = separable_taps[choice];
  for (uint32_t node = 0; node < separable_nodes; ++node) {
    const auto kernel = node_rows(rows, choice, node);
    const SeparableRow& ends = kernel[separable_ends_row(taps)];
    for (uint32_t i = 1; i <= (taps - 1) / 2; ++i)
      EXPECT_EQ(kernel[i][3] == float(i), float(i) <= ends[0]) << node << ", tap " << i;
  }
  // 10 d (i / 12)^3.5 exceeds i from the eighth tap on at d = 4 px.
  EXPECT_EQ(node_rows(rows, choice, 12)[separable_ends_row(taps)][0], 7.0f);
}

TEST(SeparableKernel, UnusedTaps_HoldLittleEnergy) {
  const std::vector<SeparableRow> rows = make_separable_rows({1.0, 0.38, 0.19});
  for (uint32_t choice = 0; choice < 3; ++choice) {
    const uint32_t taps = separable_taps[choice];
    for (uint32_t node = 0; node < separable_nodes; ++node) {
      const auto kernel = node_rows(rows, choice, node);
      const auto used = uint32_t(kernel[separable_ends_row(taps)][1]);
      for (size_t c = 0; c < 3; ++c) {
        double unused = 0;
        for (uint32_t i = used + 1; i <= (taps - 1) / 2; ++i)
          unused += 2 * double{kernel[i][c]};
        EXPECT_LT(unused, separable_min_tail) << taps << " taps, node " << node;
      }
    }
    // At d = 1/16 px all light stays within a pixel or two; at 4 px every tap counts.
    EXPECT_LE(node_rows(rows, choice, 0)[separable_ends_row(taps)][1], 2.0f);
    EXPECT_EQ(node_rows(rows, choice, 12)[separable_ends_row(taps)][1], float((taps - 1) / 2));
  }
}

// The factor on the weight of a tap at the distance sqrt(offset^2 + rise^2) in space.
double nearness(double offset, double rise, double core, double decay) {
  const double r = std::hypot(offset, rise);
  return (offset + core) / (r + core) * std::exp2(-decay * (r - offset));
}

TEST(SeparableKernel, Decay_FollowsTheProfileInSpace) {
  // Equal channels: the factor approximates the profile at the distance in space over the profile
  // at the offset, on slopes and behind steps. Bounds: 1.1 times the largest deviation.
  struct Case {
    ChannelShape shape;
    double core, bound;
  };
  for (const Case& one :
       {Case{burley_shape(4), 0, 0.013}, Case{dipole_shape(0.03, 1), separable_flat_core, 0.05},
        Case{artist_shape(1, 1), separable_flat_core, 0.069}}) {
    const double d = one.shape.d;
    double largest = 0;
    for (const double offset : {0.1 * d, 0.3 * d, d, 2 * d, 4 * d, 8 * d})
      for (const double rise : {0.0, 0.5 * offset, offset, d, 2 * d, 4 * d, 8 * d}) {
        const double exact =
            shape_R(one.shape, std::hypot(offset, rise)) / shape_R(one.shape, offset);
        const double decay = make_separable_decay({one.shape, one.shape, one.shape}, offset);
        largest = std::max(largest, std::abs(nearness(offset, rise, one.core, decay) - exact));
      }
    EXPECT_LT(largest, one.bound) << "model " << int(one.shape.model);
  }
}

} // namespace
