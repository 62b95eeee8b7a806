#include "integration/tools/references/analytic.hpp"

#include "passes/common/profiles/burley_profile.hpp"

#include <gtest/gtest.h>

namespace dermis::subsurface {
namespace {

TEST(Analytic, EdgeHasItsTabulatedValues) {
  const double x[] = {0.1, 0.25, 0.5, 1, 2, 4, 8};
  const double expected[] = {0.563178, 0.621756, 0.689769, 0.776990, 0.870563, 0.947619, 0.989248};
  for (int i = 0; i < 7; ++i) {
    EXPECT_NEAR(burley_edge(3 * x[i], 3), expected[i], 6e-7);
    EXPECT_NEAR(burley_edge(-3 * x[i], 3), 1 - expected[i], 6e-7);
  }
  EXPECT_EQ(burley_edge(0, 1), 0.5);
}

TEST(Analytic, BesselIntegralEndsAtHalfPi) {
  EXPECT_NEAR(bessel_k0_integral(60), 1.5707963267948966, 1e-9);
}

TEST(Analytic, TransferFunctionHasItsTabulatedValues) {
  const double k[] = {0.1, 0.5, 1, 2, 5};
  const double expected[] = {0.967129, 0.639632, 0.413948, 0.235103, 0.098918};
  for (int i = 0; i < 5; ++i)
    EXPECT_NEAR(burley_mtf(k[i] / 7, 7), expected[i], 6e-7);
}

TEST(Analytic, DiscIsTheCdfAtTheCentreAndContinuous) {
  EXPECT_NEAR(burley_disc(0, 2.5, 1.3), burley_cdf(2.5, 1.3), 1e-12);
  EXPECT_NEAR(burley_disc(2.5 - 1e-7, 2.5, 1.3), burley_disc(2.5 + 1e-7, 2.5, 1.3), 1e-4);
  EXPECT_LT(burley_disc(3, 2.5, 1.3), burley_disc(2, 2.5, 1.3));
}

TEST(Analytic, RimOfAHugeDiscIsAnEdge) {
  // A curvature of radius 1e4 d moves the edge by about x^2 / 2e4.
  EXPECT_NEAR(burley_disc(1e4 - 1, 1e4, 1), burley_edge(1, 1), 5e-4);
  EXPECT_NEAR(burley_disc(1e4 + 1, 1e4, 1), burley_edge(-1, 1), 5e-4);
}

TEST(Analytic, GaussianLightHasItsTabulatedValues) {
  EXPECT_NEAR(burley_gaussian_centre(0.5, 1), 0.247374, 6e-7);
  EXPECT_NEAR(burley_gaussian_centre(2, 1), 0.605886, 6e-7);
  EXPECT_NEAR(burley_gaussian_centre(1e4, 1), 1, 1e-6); // Wide light: the furnace.
}

} // namespace
} // namespace dermis::subsurface
