// Compares the kernels' guidance functions on a device with their CPU reference in fp64. Bounds
// follow from the precision that Vulkan requires: one ulp for sums and products, 2.5 ulp for
// quotients. `magnitude` is the formula with absolute values of its terms, so that a bound also
// holds if terms cancel.
#include "integration/tools/references/guidance.hpp"
#include "tests/shaders/common/kernel_fixture.hpp"

#include "test_guidance.spv.h"
#include "tests/support/matchers.hpp"

#include <cmath>
#include <limits>
#include <random>

namespace dermis::subsurface::guidance_kernel {
namespace {

constexpr uint32_t cases = 512, rows = 3;
constexpr double ulp = std::numeric_limits<float>::epsilon();

struct Case { // The layout that test_guidance.comp reads.
  float sigma2_target, kappa, eta, eps_alpha;
  float minimum, maximum, variance, mean_count;
  float mean_f, mean_g, covariance, variance_g;
  float f, g, eta_cv, requested;

  GuidanceSettings settings() const {
    return {.sigma2_target = sigma2_target,
            .kappa = kappa,
            .eta = eta,
            .eta_cv = eta_cv,
            .eps_alpha = eps_alpha,
            .min_samples = minimum,
            .max_samples = maximum};
  }
  MovingCovariance moments() const { return {mean_f, mean_g, covariance, variance_g, true}; }
};
static_assert(sizeof(Case) == 4 * 4 * sizeof(float));

std::vector<Case> make_cases() {
  std::mt19937 random(11);
  const auto between = [&](double low, double high) {
    return static_cast<float>(std::uniform_real_distribution<double>(low, high)(random));
  };
  const auto octaves = [&](double low, double high) { return std::exp2(between(low, high)); };
  std::vector<Case> made;
  for (uint32_t i = 0; i < cases; ++i) {
    const float minimum = std::floor(between(1, 16)),
                maximum = minimum + std::floor(between(0, 100));
    const float variance_g = i % 5 == 0 ? 0 : octaves(-24, 4);
    // Some requested numbers are outside of the range; none is halfway between two integers, which
    // GLSL lets a driver round either way.
    const float requested = std::round(between(-20, 140)) + (i % 3 == 0   ? 0.499f
                                                             : i % 3 == 1 ? -0.499f
                                                                          : 0.0f);
    made.push_back({octaves(-20, -6), i % 7 == 0 ? 0 : between(0, 1), between(0.01, 1),
                    octaves(-24, -14), minimum, maximum, i % 11 == 0 ? 0 : octaves(-24, 0),
                    between(1, 128), i % 13 == 0 ? 0 : octaves(-8, 8),
                    i % 6 == 0 ? 0 : octaves(-8, 8), between(-1, 1) * octaves(-16, 4), variance_g,
                    octaves(-8, 8), octaves(-8, 8), between(0.001, 1), requested});
  }
  made[0].mean_f = made[0].mean_g = made[0].covariance = made[0].variance_g = 0; // All is dark.
  return made;
}

class GuidanceKernel : public dermis::testing::KernelTest {
protected:
  void SetUp() override {
    KernelTest::SetUp();
    if (IsSkipped() || HasFatalFailure()) return;
    answers = answers_of({"test_guidance", test_guidance_spirv}, cases, rows,
                         {.questions = std::as_bytes(std::span(requested))});
    ASSERT_EQ(answers.size(), size_t{4} * cases * rows);
  }
  double at(size_t x, size_t row, size_t channel) const {
    return double(answers[4 * (row * cases + x) + channel]);
  }

  const std::vector<Case> requested = make_cases();
  std::vector<float> answers;
};

TEST_F(GuidanceKernel, SampleNumbersEqualTheReference) {
  size_t whole = 0;
  for (size_t i = 0; i < requested.size(); ++i) {
    const Case& one = requested[i];
    const GuidanceSettings settings = one.settings();
    const double required = required_samples(one.variance, one.mean_count, settings);
    // Two quotients and seven sums and products.
    const double ratio = double(one.variance) / settings.sigma2_target;
    const double magnitude =
        settings.kappa * (ratio + 1) * one.mean_count * (2 / settings.eta + 2) +
        ratio * one.mean_count;
    const double bound = (2 * 2.5 + 7) * ulp * magnitude;
    EXPECT_NEAR(at(i, 0, 0), required, bound) << i;
    EXPECT_EQ(at(i, 0, 2), clamped_samples(one.requested, settings)) << i << ": " << one.requested;
    // Both results are equal unless the bound contains a value halfway between two integers.
    const int low = clamped_samples(required - bound, settings),
              high = clamped_samples(required + bound, settings);
    EXPECT_THAT(at(i, 0, 1), AllOf(::testing::Ge(low), ::testing::Le(high)))
        << i << ": " << required;
    whole += low == high ? 1 : 0;
  }
  EXPECT_GT(whole, cases * 95 / 100) << "number of compared decisions";
}

TEST_F(GuidanceKernel, ControlWeightsEqualTheReference) {
  for (size_t i = 0; i < requested.size(); ++i) {
    const Case& one = requested[i];
    const double eps = one.eps_alpha;
    // Two sums and a quotient; the upper limit is a sum and a quotient of non-negative values.
    double magnitude = (std::abs(double(one.covariance)) + eps) / (double(one.variance_g) + eps);
    if (one.mean_g > 0) magnitude += (double(one.mean_f) + one.mean_g) / one.mean_g;
    EXPECT_NEAR(at(i, 0, 3), control_weight(one.moments(), eps), (2 + 2.5) * ulp * magnitude) << i;
  }
  EXPECT_EQ(at(0, 0, 3), 1) << "if all is dark";
}

TEST_F(GuidanceKernel, MovingMomentsEqualTheReference) {
  for (size_t i = 0; i < requested.size(); ++i) {
    const Case& one = requested[i];
    const double eta = one.eta_cv, f = std::abs(double(one.f) - one.mean_f),
                 g = std::abs(double(one.g) - one.mean_g);
    MovingVariance variance{one.mean_f, one.variance_g, true};
    variance.add(one.f, eta);
    MovingCovariance moments = one.moments();
    moments.add(one.f, one.g, eta);
    // A mean: difference, product, sum. A variance: two differences, one of them squared, three
    // products, a sum.
    const double mean_f = 3 * ulp * (double(one.mean_f) + eta * f),
                 mean_g = 3 * ulp * (double(one.mean_g) + eta * g);
    const double spread = 8 * ulp;
    EXPECT_NEAR(at(i, 1, 0), variance.mean, mean_f) << i;
    EXPECT_NEAR(at(i, 1, 1), variance.variance, spread * variance.variance) << i;
    EXPECT_NEAR(at(i, 2, 0), moments.mean_f, mean_f) << i;
    EXPECT_NEAR(at(i, 2, 1), moments.mean_g, mean_g) << i;
    EXPECT_NEAR(at(i, 2, 2), moments.covariance,
                spread * (1 - eta) * (std::abs(double(one.covariance)) + eta * f * g))
        << i;
    EXPECT_NEAR(at(i, 2, 3), moments.variance_g, spread * moments.variance_g) << i;
  }
}

} // namespace
} // namespace dermis::subsurface::guidance_kernel
