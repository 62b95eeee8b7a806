// Properties of the radial profiles in fp64: totals, closed forms against quadrature, inverses and
// transfer functions.
#include "passes/common/profiles/burley_profile.hpp"
#include "passes/common/profiles/profile.hpp"
#include "passes/common/profiles/shape.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>

namespace {

using namespace dermis;
using namespace dermis::subsurface;

struct Named {
  const char* name;
  ChannelShape shape;
};

void PrintTo(const Named& named, std::ostream* out) {
  *out << named.name;
}

class EveryShape : public ::testing::TestWithParam<Named> {
protected:
  const ChannelShape& shape = GetParam().shape;
};

INSTANTIATE_TEST_SUITE_P(Profiles, EveryShape,
                         ::testing::Values(Named{"burley", burley_shape(0.7)},
                                           Named{"dipole_skin", dipole_shape(0.032, 0.74)},
                                           Named{"dipole_milk", dipole_shape(0.0011, 2.55)},
                                           Named{"dipole_ketchup", dipole_shape(0.97, 0.07)},
                                           Named{"artist", artist_shape(1.001, 0.48)}),
                         [](const auto& one) { return std::string(one.param.name); });

// Integrates f over [a, b] by Simpson's rule with n intervals.
template <class F> double simpson(F f, double a, double b, int n) {
  double sum = f(a) + f(b);
  for (int i = 1; i < n; ++i)
    sum += f(a + (b - a) * i / n) * (i % 2 == 1 ? 4 : 2);
  return sum * (b - a) / (3 * n);
}

TEST_P(EveryShape, CdfIsTheIntegralOfTheDensity) {
  // Burley's radial density is finite at 0, too; Simpson's error at 4000 intervals over 10 d is
  // below 1e-10.
  for (const double r : {0.1, 0.5, 1.0, 3.0, 10.0}) {
    const double end = r * shape.d;
    const double integral =
        simpson([&](double x) { return shape_pdf(shape, std::max(x, 1e-12 * end)); }, 0, end, 4000);
    EXPECT_NEAR(shape_cdf(shape, end), integral, 1e-9) << r;
    EXPECT_NEAR(shape_cdf(shape, end) + shape_survival(shape, end), 1, 1e-14);
    EXPECT_NEAR(shape_pdf(shape, end), 2 * std::numbers::pi * end * shape_R(shape, end),
                1e-14 / shape.d);
  }
  EXPECT_EQ(shape_cdf(shape, 0), 0);
  EXPECT_NEAR(shape_cdf(shape, 400 * shape.d), 1, 1e-9); // The total is 1.
}

TEST_P(EveryShape, InverseInvertsTheSurvival) {
  for (const double u : {0.999999, 0.9, 0.5, 0.1, 0.01, 1e-4, 1e-6}) {
    const double r = shape_inverse_survival(shape, u);
    EXPECT_NEAR(shape_survival(shape, r) / u, 1, 1e-11) << u;
  }
  EXPECT_NEAR(shape_inverse_survival(shape, 1), 0, 1e-9 * shape.d);
  EXPECT_TRUE(std::isfinite(shape_inverse_survival(shape, 0)));
  EXPECT_TRUE(std::isfinite(shape_inverse_survival(shape, std::nan(""))));
}

TEST_P(EveryShape, DFollowsTheRadiusOfNinetyNinePercent) {
  EXPECT_NEAR(shape_inverse_survival(shape, 0.01), 12.95264 * shape.d, 1e-4 * shape.d);
  // The part that the reference cuts off.
  EXPECT_NEAR(shape_survival(shape, shape_reach(shape)), 9.54e-4, 1e-6);
}

TEST_P(EveryShape, TransferFunctionIsTheHankelTransform) {
  // H(k) = integral of pdf(r) J0(k r). The integrand over the survival variable is bounded.
  for (const double k : {0.05, 0.3, 1.0}) {
    const double far = shape_inverse_survival(shape, 1e-7);
    const double numeric = simpson(
        [&](double x) {
          // x^2 concentrates points where the density is steep.
          const double r = std::max(far * x * x, 1e-12);
          return shape_pdf(shape, r) * std::cyl_bessel_j(0, k / shape.d * r) * 2 * far * x;
        },
        0, 1, 200000);
    EXPECT_NEAR(shape_transfer(shape, k / shape.d), numeric, 1e-5) << k;
  }
  EXPECT_NEAR(shape_transfer(shape, 0), 1, 1e-14);
}

TEST_P(EveryShape, ScalesWithLengths) {
  const ChannelShape twice = scaled(shape, 2);
  EXPECT_NEAR(twice.d, 2 * shape.d, 1e-14);
  EXPECT_NEAR(shape_cdf(twice, 2 * shape.d), shape_cdf(shape, shape.d), 1e-13);
  EXPECT_NEAR(shape_R(twice, 2 * shape.d), shape_R(shape, shape.d) / 4, 1e-13);
  EXPECT_EQ(scaled(shape, 0).d, 0);
  EXPECT_EQ(shape_cdf(scaled(shape, 0), 1e-30), 1);
}

TEST(Dipole, MatchesThePapersConstantsAndReflectance) {
  EXPECT_NEAR(dipole_fdr(1.3), 0.444763, 1e-6);
  // Skin1 and wholemilk in figure 5 of Jensen et al. 2001, which prints the diffuse reflectances
  // 0.44 0.22 0.13 and 0.91 0.88 0.76.
  EXPECT_NEAR(dipole_albedo(0.032, 0.74), 0.44, 0.01);
  EXPECT_NEAR(dipole_albedo(0.17, 0.88), 0.22, 0.01);
  EXPECT_NEAR(dipole_albedo(0.48, 1.01), 0.13, 0.01);
  EXPECT_NEAR(dipole_albedo(0.0011, 2.55), 0.91, 0.01);
  EXPECT_NEAR(1 / make_dipole(0.032, 0.74).sigma_tr, 3.673, 1e-3); // Diffuse mean free path in mm.
}

TEST(Artist, MatchesSkinWithoutItsNarrowestGaussian) {
  double sum = 0;
  for (const ArtistGaussian& one : artist_gaussians)
    sum += one.weight;
  EXPECT_NEAR(sum, artist_total, 1e-12);
  EXPECT_NEAR(artist_width(0.37), 0.371, 1e-12);
  // gamma equals the strength for every radius.
  EXPECT_NEAR(shape_gamma(artist_shape(1, 0.48), 0.1), 0.48, 1e-12);
  EXPECT_NEAR(shape_gamma(artist_shape(1, 0.48), 5), 0.48, 1e-12);
}

TEST(Gamma, FallsWithTheDirectRadius) {
  for (const ChannelShape& shape : {burley_shape(1), dipole_shape(0.17, 0.88)}) {
    double before = 1;
    for (const double r0 : {0.01, 0.1, 0.5, 1.0, 4.0}) {
      const double gamma = shape_gamma(shape, r0);
      EXPECT_LT(gamma, before);
      EXPECT_NEAR(gamma, 1 - shape_cdf(shape, r0), 1e-14);
      before = gamma;
    }
  }
}

TEST(DirectRadius, OnlyInscribed_TakesNoLightOfOtherPixels) {
  EXPECT_EQ(direct_radius(DirectRadius::inscribed, 1, 2), 0.5);
  EXPECT_NEAR(direct_radius(DirectRadius::circumscribed, 1, 1), std::sqrt(0.5), 1e-15);
  // Weight in the centre pixel at d = 3 px: the direct part and the taps beyond r0 within the
  // pixel. Inscribed: exactly the integral over the pixel, 0.0880; circumscribed: 24 % more.
  const double d = 3;
  const auto landing = [&](double r0) {
    double outside = 0; // Polar integral over the square beyond r0.
    constexpr int angles = 4000;
    for (int i = 0; i < angles; ++i) {
      const double theta = (i + 0.5) / angles * std::numbers::pi / 4;
      const double edge = 0.5 / std::cos(theta);
      if (edge > r0) outside += (burley_cdf(edge, d) - burley_cdf(r0, d)) / angles;
    }
    return burley_cdf(r0, d) + outside;
  };
  EXPECT_NEAR(landing(direct_radius(DirectRadius::inscribed, 1, 1)), 0.0880, 1e-4);
  EXPECT_NEAR(landing(direct_radius(DirectRadius::circumscribed, 1, 1)), 0.1092, 1e-4);
}

TEST(AlbedoInversion, HasTheThreeFitsOfChristensenAndBurley) {
  const double expected[3][4] = {
      {0.8, 1.05, 1.10, 8.3797}, {0.33, 2.2468, 2.3431, 3.5}, {1, 0.906, 1.04, 23.6511}};
  for (const auto& row : expected) {
    EXPECT_NEAR(burley_scaling_searchlight(row[0]), row[1], 1e-4);
    EXPECT_NEAR(burley_scaling_diffuse(row[0]), row[2], 1e-4);
    EXPECT_NEAR(burley_scaling_dmfp(row[0]), row[3], 1e-4);
  }
  EXPECT_TRUE(std::isfinite(burley_scaling_searchlight(std::nan(""))));
  EXPECT_EQ(burley_scaling_diffuse(7), burley_scaling_diffuse(1));
}

std::optional<Profile> parse(const std::string& text, Diagnostics& diagnostics) {
  const auto document = parse_document("test.json", text, diagnostics);
  return document ? read_profile(*document, diagnostics) : std::nullopt;
}

TEST(ProfileModels, MeanFreePathInside_MatchesTheScaling) {
  Diagnostics diagnostics;
  const auto searchlight =
      parse(R"({"dermis_profile": 1, "name": "p", "source": "t", "mfp_mm": [1, 2, 0],
                                     "albedo": [0.8, 0.33, 1]})",
            diagnostics);
  ASSERT_TRUE(searchlight) << format_as_json(diagnostics);
  EXPECT_NEAR(searchlight->d_mm[0], 1 / 1.05, 1e-12);
  EXPECT_NEAR(searchlight->d_mm[1], 2 / burley_scaling_searchlight(0.33), 1e-12);
  EXPECT_EQ(searchlight->d_mm[2], 0);
  const auto diffuse =
      parse(R"({"dermis_profile": 1, "name": "p", "source": "t", "mfp_mm": [1, 2, 0],
                                 "scaling": "diffuse_surface", "albedo": [0.8, 0.33, 1]})",
            diagnostics);
  ASSERT_TRUE(diffuse);
  EXPECT_NEAR(diffuse->d_mm[0], 1 / 1.10, 1e-12);
}

TEST(ProfileModels, NumbersOfAnotherModel_AreRejected) {
  Diagnostics diagnostics;
  EXPECT_FALSE(parse("{\"dermis_profile\": 1, \"name\": \"p\", \"source\": \"t\",\n"
                     " \"dmfp_mm\": [1, 2, 3], \"albedo\": [1, 1, 1],\n \"falloff\": [1, 1, 1]}",
                     diagnostics));
  ASSERT_EQ(diagnostics.count(Severity::error), 1u) << format_as_json(diagnostics);
  const Diagnostic& one = diagnostics.list[0];
  EXPECT_EQ(one.id, DiagnosticId::profile_keys);
  EXPECT_EQ(one.where.line, 3u);
  EXPECT_EQ(one.where.column, 13u);
  EXPECT_EQ(one.where.pointer, "/falloff");
  EXPECT_NE(one.text.find("artist"), std::string::npos);
  EXPECT_NE(one.text.find("burley"), std::string::npos);
}

TEST(ProfileModels, OneLengthGivenTwiceIsRejectedOnce) {
  for (const char* text : {R"("dmfp_mm": [1, 2, 3], "mfp_mm": [1, 2, 3])",
                           R"("dmfp_mm": [1, 2, 3], "scaling": "searchlight")"}) {
    Diagnostics diagnostics;
    EXPECT_FALSE(parse(
        std::string(R"({"dermis_profile": 1, "name": "p", "source": "t", "albedo": [1, 1, 1], )") +
            text + "}",
        diagnostics));
    ASSERT_EQ(diagnostics.count(Severity::error), 1u) << format_as_json(diagnostics);
    EXPECT_EQ(diagnostics.list[0].id, DiagnosticId::profile_keys);
  }
}

TEST(ProfileModels, ReadsBackBitForBit) {
  for (const auto& entry :
       std::filesystem::directory_iterator(DERMIS_SOURCE_DIR "/configs/profiles")) {
    Diagnostics diagnostics;
    const auto document = read_document(entry.path().string(), diagnostics);
    const auto profile = read_profile(*document, diagnostics);
    ASSERT_TRUE(profile) << entry.path();
    const auto again = parse(R"({"dermis_profile": 1, "name": "p", "source": "t", )" +
                                 profile_members(*profile) + "}",
                             diagnostics);
    ASSERT_TRUE(again) << format_as_json(diagnostics);
    EXPECT_EQ(again->d_mm, profile->d_mm);
    EXPECT_EQ(again->model, profile->model);
    const std::string reported = describe_profile(*profile);
    EXPECT_NE(reported.find(profile->name), std::string::npos);
    EXPECT_NE(reported.find(" mm"), std::string::npos);
  }
}

TEST(BurleySamplers, TheApproximateInverseHasItsPublishedErrors) {
  double worst = 0, distance = 0, mean = 0, weight_mean = 0, minimum = 1e9;
  constexpr int n = 200000;
  for (int i = 0; i < n; ++i) {
    const double xi = (i + 0.5) / n, u = 1 - xi;
    const double r = burley_approximate_survival(u, 1), exact = burley_inverse_survival(u, 1);
    if (xi <= 0.9 && xi > 1e-4) worst = std::max(worst, std::abs(r / exact - 1));
    distance = std::max(distance, std::abs(burley_cdf(r, 1) - xi));
    mean += r / n;
    weight_mean += burley_approximate_weight(u) / n;
    minimum = std::min(minimum, burley_approximate_weight(u));
  }
  EXPECT_NEAR(worst, 0.045, 0.001);
  EXPECT_NEAR(distance, 0.00987, 0.0002);
  EXPECT_NEAR(mean, 2.4286, 0.001);
  EXPECT_NEAR(weight_mean, 1, 1e-4); // The samples miss the tail beyond 1 - 1/n.
  EXPECT_NEAR(minimum, 0.945, 0.001);
}

} // namespace
