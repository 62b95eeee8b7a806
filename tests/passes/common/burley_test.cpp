#include "passes/common/profiles/burley_profile.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace dermis::subsurface {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

TEST(Burley, CdfHasTheValuesOfTheClosedForm) {
  // Closed form, six digits.
  const double r[] = {0.5, 1, 2, 3, 5, 10};
  const double expected[] = {0.213506, 0.370632, 0.581103, 0.711644, 0.856659, 0.973233};
  for (int i = 0; i < 6; ++i)
    EXPECT_NEAR(burley_cdf(2.5 * r[i], 2.5), expected[i], 5e-7);
}

TEST(Burley, DensityIntegratesToTheCdf) {
  // Simpson's rule on 2000 intervals: the error is (h/d)^4 / 180 * 10 < 1e-9.
  const double d = 0.7, end = 3.5;
  const int n = 2000;
  double sum = 0;
  for (int i = 0; i <= n; ++i)
    sum += burley_pdf(end * i / n, d) * (i == 0 || i == n ? 1 : i % 2 == 1 ? 4 : 2);
  EXPECT_NEAR(sum * end / n / 3, burley_cdf(end, d), 1e-9);
}

TEST(Burley, PdfIsTheProfileTimesTheCircle) {
  for (const double r : {1e-3, 0.4, 2.0, 30.0})
    EXPECT_NEAR(burley_pdf(r, 1.3), 2 * 3.14159265358979323846 * r * burley_R(r, 1.3), 1e-14);
}

TEST(Burley, MomentsMatchTheLiterature) {
  // E[r] = 2.5 d, E[r^2] = 14 d^2; midpoint rule in u with 1e6 points; the clamped tail is 6e-8.
  const int n = 1000000;
  double first = 0, second = 0;
  for (int i = 0; i < n; ++i) {
    const double r = burley_inverse_survival((i + 0.5) / n, 2.0);
    first += r / n;
    second += r * r / n;
  }
  EXPECT_NEAR(first, 5.0, 1e-4);
  EXPECT_NEAR(second, 56.0, 1e-2);
}

TEST(Burley, ExactInverseInvertsTheCdf) {
  for (double u = 1e-7; u < 1; u = u * 1.07 + 1e-6)
    EXPECT_NEAR(1 - burley_cdf(burley_inverse_survival(u, 3.0), 3.0), u, 1e-12) << u;
}

TEST(Burley, ExactInverseHasTheTabulatedRadii) {
  const double xi[] = {0.5, 0.9, 0.99, 0.997, 0.999};
  const double expected[] = {1.55218, 6.06223, 12.95264, 16.56440, 19.86022};
  for (int i = 0; i < 5; ++i)
    EXPECT_NEAR(burley_inverse_survival(1 - xi[i], 1), expected[i], 6e-6);
}

TEST(Burley, InverseIsFiniteAndNotNegativeForAnyInput) {
  for (const double u : {0.0, -1.0, 1.0, 2.0, nan, 1e-300, 1 - 1e-16}) {
    const double exact = burley_inverse_survival(u, 1), sampled = burley_sample_survival(u, 1);
    EXPECT_TRUE(exact >= 0 && exact < 50) << u;
    EXPECT_TRUE(sampled >= 0 && sampled < 50) << u;
    EXPECT_TRUE(std::isfinite(burley_sample_weight(u))) << u;
  }
}

TEST(Burley, SamplerStaysWithinItsStatedErrors) {
  // Stated errors: relative radius < 0.0052, distance to the cdf < 0.0016, |W - 1| < 0.0125, mean W
  // = 1
  // +- 1e-5.
  const int n = 200000;
  double mean = 0;
  for (int i = 0; i < n; ++i) {
    const double u = (i + 0.5) / n;
    const double r = burley_sample_survival(u, 1), exact = burley_inverse_survival(u, 1);
    ASSERT_LE(std::abs(r - exact), 0.0052 * exact + 1e-12) << u;
    ASSERT_LE(std::abs(1 - burley_cdf(r, 1) - u), 0.0016) << u;
    const double w = burley_sample_weight(u);
    ASSERT_LE(std::abs(w - 1), 0.0125) << u;
    mean += w / n;
  }
  EXPECT_NEAR(mean, 1, 1e-5);
}

TEST(Burley, WeightedSamplerReproducesTheCdf) {
  // E[W; r < R] = cdf(R): midpoint rule; the jump at R costs 1/n.
  const int n = 400000;
  for (const double radius : {0.5, 2.0, 6.0, 15.0}) {
    double sum = 0;
    for (int i = 0; i < n; ++i) {
      const double u = (i + 0.5) / n;
      if (burley_sample_survival(u, 1) < radius) sum += burley_sample_weight(u) / n;
    }
    EXPECT_NEAR(sum, burley_cdf(radius, 1), 1e-5) << radius;
  }
}

TEST(Burley, ScalingHasThePublishedValues) {
  EXPECT_NEAR(burley_scaling_dmfp(0.8), 8.3797, 5e-5);
  EXPECT_NEAR(burley_scaling_dmfp(0.33), 3.5, 1e-12);
  EXPECT_NEAR(burley_scaling_dmfp(1), 23.6511, 5e-5);
}

TEST(Burley, InvalidAlbedo_ScalesLikeTheNearestValidOne) {
  EXPECT_EQ(burley_scaling_dmfp(-1), burley_scaling_dmfp(0));
  EXPECT_EQ(burley_scaling_dmfp(2), burley_scaling_dmfp(1));
  EXPECT_EQ(burley_scaling_dmfp(nan), 3.5);
}

TEST(Burley, NoMeanFreePathMeansNoScattering) {
  EXPECT_EQ(burley_d_from_dmfp(0, 0.5), 0);
  EXPECT_EQ(burley_d_from_dmfp(-3, 0.5), 0);
  EXPECT_EQ(burley_d_from_dmfp(nan, 0.5), 0);
  EXPECT_NEAR(burley_d_from_dmfp(7, 0.33), 2, 1e-12);
}

TEST(Burley, ManyRadiiAtOnceGiveEqualProfiles) {
  std::vector<double> radii, values;
  for (double r = 1e-9; r < 240; r *= 1.013)
    radii.push_back(r);
  values.resize(radii.size());
  for (const double d : {1e-4, 0.7, 3.0}) {
    std::vector<double> scaled = radii;
    for (double& r : scaled)
      r *= d;
    burley_R(scaled, d, values);
    for (size_t i = 0; i < scaled.size(); ++i)
      ASSERT_NEAR(values[i] / burley_R(scaled[i], d), 1, 2e-14) << "d " << d << ", r " << scaled[i];
  }
  radii = {260, 1e9};
  values.resize(2);
  burley_R(radii, 1, values);
  EXPECT_LT(values[0], 1e-36); // Equal to the value at 250 d.
  EXPECT_EQ(values[0], values[1]);
  burley_R(radii, 0, values);
  EXPECT_EQ(values[0], 0);
}

} // namespace
} // namespace dermis::subsurface
