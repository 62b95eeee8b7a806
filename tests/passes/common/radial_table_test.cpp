// Tests the sampling table of profiles without closed forms against the profiles it was made of.
#include "passes/common/profiles/burley_profile.hpp"
#include "tests/passes/common/cpu/radial_lookup.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace {

using namespace dermis::subsurface;

struct Tabled {
  const char* name;
  ProfileShape shape;
  double mean_square; // E[r^2] of red in mm^2, closed form.
};

void PrintTo(const Tabled& named, std::ostream* out) {
  *out << named.name;
}

// Returns E[r^2] from the curvature of the transfer function at 0: 2 sum z e^(-z sigma) / (sigma
// sum e^(-z sigma)).
double mean_square(const Dipole& dipole) {
  double sum = 0, total = 0;
  for (const double z : {dipole.z_real, dipole.z_virtual}) {
    sum += z * std::exp(-z * dipole.sigma_tr);
    total += std::exp(-z * dipole.sigma_tr);
  }
  return 2 * sum / (dipole.sigma_tr * total);
}
double artist_mean_square(double width) {
  double sum = 0;
  for (const ArtistGaussian& one : artist_gaussians)
    sum += one.weight / artist_total * 2 * one.variance_mm2 * width * width;
  return sum;
}

class RadialTable : public ::testing::TestWithParam<Tabled> {
protected:
  const ProfileShape& shape = GetParam().shape;
  std::vector<RadialRow> rows = make_radial_rows(shape, 0);
  float d = static_cast<float>(shape[0].d);
};

INSTANTIATE_TEST_SUITE_P(
    Profiles, RadialTable,
    ::testing::Values(
        Tabled{"dipole",
               {dipole_shape(0.032, 0.74), dipole_shape(0.17, 0.88), dipole_shape(0.48, 1.01)},
               mean_square(make_dipole(0.032, 0.74))},
        Tabled{"artist",
               {artist_shape(1.001, 0.48), artist_shape(0.371, 0.41), artist_shape(0.301, 0.28)},
               artist_mean_square(1.001)}),
    [](const auto& one) { return std::string(one.param.name); });

TEST_P(RadialTable, ReturnsDensityAndSurvivalOfEveryChannel) {
  for (const double in_d : {1e-3, 0.01, 0.1, 0.5, 1.0, 3.0, 8.0, 15.0}) {
    const double r = in_d * shape[0].d;
    const auto falloff = radial_falloff(rows, d, static_cast<float>(r));
    const auto survival = radial_survival(rows, d, static_cast<float>(r));
    for (size_t c = 0; c < 3; ++c) {
      const double reference = 2 * std::numbers::pi * shape_R(shape[c], r);
      // Tolerance relative to the value or, far out, to the peak: linear steps of 1/24 octave in
      // log R.
      EXPECT_NEAR(falloff[c], reference, 4e-3 * reference + 1e-9) << in_d << " d, channel " << c;
      EXPECT_NEAR(survival[c], shape_survival(shape[c], r), 2e-4) << in_d << " d, channel " << c;
    }
  }
}

TEST_P(RadialTable, InverseIsWithinAThousandthOfD) {
  for (double u = 0.9999; u > 1e-6; u *= 0.83)
    EXPECT_NEAR(radial_sample(rows, static_cast<float>(u)).r, shape_inverse_survival(shape[0], u),
                1e-3 * shape[0].d)
        << u;
}

TEST_P(RadialTable, WeightsByTheTableDensityAreUnbiased) {
  // The weight is pdf / density. Its mean is 1 and the mean of r^2 is that of the profile, within
  // 0.1 %.
  double total = 0, square = 0, minimum = 1e9, maximum = 0;
  constexpr int n = 400000;
  for (int i = 0; i < n; ++i) {
    const RadialSample radial = radial_sample(rows, static_cast<float>((i + 0.5) / n));
    const double r = static_cast<double>(radial.r);
    const double weight = shape_pdf(shape[0], r) / static_cast<double>(radial.density);
    total += weight / n;
    square += weight * r * r / n;
    if (i > 0) minimum = std::min(minimum, weight), maximum = std::max(maximum, weight);
  }
  EXPECT_NEAR(total, 1, 1e-4);
  EXPECT_NEAR(square / GetParam().mean_square, 1, 1e-3);
  EXPECT_GT(minimum, 0.95);
  EXPECT_LT(maximum, 1.05);
}

TEST(SecondMoment, BurleySamplers_HaveFourteenDSquared) {
  double polynomial = 0, exact = 0, approximate = 0, unweighted = 0;
  constexpr int n = 2000000;
  for (int i = 0; i < n; ++i) {
    const double u = (i + 0.5) / n;
    const auto square = [](double r) { return r * r / n; };
    polynomial += burley_sample_weight(u) * square(burley_sample_survival(u, 1));
    exact += square(burley_inverse_survival(u, 1));
    approximate += burley_approximate_weight(u) * square(burley_approximate_survival(u, 1));
    unweighted += square(burley_approximate_survival(u, 1));
  }
  EXPECT_NEAR(polynomial / 14, 1, 1e-3);
  EXPECT_NEAR(exact / 14, 1, 1e-3);
  EXPECT_NEAR(approximate / 14, 1, 1e-3);
  EXPECT_NEAR(unweighted, 12.515, 0.01); // 10.6 % too low, as published.
}

} // namespace
