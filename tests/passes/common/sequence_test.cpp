#include "tests/passes/common/cpu/sequence.hpp"

#include "passes/common/profiles/burley_profile.hpp"
#include "tests/passes/common/cpu/burley_mixture.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace dermis::subsurface {
namespace {

TEST(Sequence, StepsArePowersOfThePlasticNumber) {
  double g = 1.3;
  for (int i = 0; i < 60; ++i)
    g = std::cbrt(g + 1);
  EXPECT_EQ(r2_step[0], static_cast<uint32_t>(std::llround(std::exp2(32) / g)));
  EXPECT_EQ(r2_step[1], static_cast<uint32_t>(std::llround(std::exp2(32) / (g * g))));
}

// Returns the largest difference between the fraction of points in [0, x) x [0, y) and its area, on
// a grid of 32 x 32 corners.
double discrepancy(uint32_t first, uint32_t count) {
  double largest = 0;
  for (uint32_t i = 1; i <= 32; ++i)
    for (uint32_t j = 1; j <= 32; ++j) {
      uint32_t inside = 0;
      for (uint32_t k = 0; k < count; ++k) {
        const auto point = r2_point({0, 0}, first + k);
        inside +=
            uint64_t{point[0]} < (uint64_t{i} << 27) && uint64_t{point[1]} < (uint64_t{j} << 27);
      }
      largest = std::max(largest, std::abs(inside / double(count) - i * j / 1024.0));
    }
  return largest;
}

TEST(Sequence, NoIndexLosesPrecision) {
  // Any 64 consecutive points are as even as the first 64; independent points would deviate by
  // about 0.1.
  for (const uint32_t first : {0u, 1u << 24, 1u << 31, 0xffffffc0u, 0xffffffffu})
    EXPECT_LT(discrepancy(first, 64), 0.07) << first;
}

TEST(Sequence, ContinuesWhenTheIndexWraps) {
  const auto last = r2_point({5, 7}, 0xffffffffu), next = r2_point({5, 7}, 0);
  EXPECT_EQ(next[0], last[0] + r2_step[0]);
  EXPECT_EQ(next[1], last[1] + r2_step[1]);
}

TEST(Sequence, HashesAreUniformAndUncorrelated) {
  // The mean of uniform numbers has sd 0.289 / sqrt(65536) = 0.0011; the correlation of independent
  // numbers has sd 0.0039.
  double mean[3] = {}, product = 0;
  for (uint32_t y = 0; y < 256; ++y)
    for (uint32_t x = 0; x < 256; ++x) {
      const auto a = pcg3d16({x, y, 9}), b = pcg3d16({x + 1, y, 9}), c = pcg3d16({x, y, 10});
      for (size_t i = 0; i < 3; ++i) {
        ASSERT_LT(a[i], 65536u);
        mean[i] += a[i] / 65536.0 / 65536;
      }
      product += 12 * (a[0] / 65536.0 - 0.5) * (b[0] / 65536.0 - 0.5) / 65536;
      product += 12 * (a[0] / 65536.0 - 0.5) * (c[0] / 65536.0 - 0.5) / 65536;
    }
  for (const double one : mean)
    EXPECT_NEAR(one, 0.5, 0.005);
  EXPECT_NEAR(product, 0, 0.03);
}

TEST(Mixture, InverseInvertsTheSurvival) {
  for (const PerChannel& d :
       {PerChannel{1, 0.38, 0.19}, {16, 8, 4}, {16, 4, 2}, {2, 0, 1}, {3, 0, 0}, {1, 1, 1}})
    for (double u = 1e-6; u <= 1; u = std::min(u * 1.3, u < 1 ? 1.0 : 2.0))
      EXPECT_NEAR(burley_mixture_survival(burley_mixture_inverse(u, d), d), u, 2e-6 + 1e-7 * u)
          << d[0] << " " << d[1] << " " << d[2] << " at " << u;
}

TEST(Mixture, OneChannel_EqualsTheChannel) {
  for (const double u : {0.9, 0.5, 0.01}) {
    EXPECT_NEAR(burley_mixture_inverse(u, {2, 2, 2}), burley_inverse_survival(u, 2), 1e-9);
    EXPECT_NEAR(burley_mixture_inverse(u, {0, 2, 0}), burley_inverse_survival(u, 2), 1e-9);
  }
}

} // namespace
} // namespace dermis::subsurface
