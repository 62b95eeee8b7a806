// Tests moving moments and values derived from them against their definitions.
#include "integration/tools/references/guidance.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace dermis::subsurface {
namespace {

struct Pairs {
  std::vector<double> f, g;
};
Pairs random_pairs(size_t count) {
  std::mt19937_64 random(17);
  std::normal_distribution<double> normal;
  Pairs pairs;
  for (size_t i = 0; i < count; ++i) {
    const double g = 1 + 0.3 * normal(random);
    pairs.f.push_back(2 + 0.7 * g + 0.2 * normal(random) + 0.5 * std::sin(0.01 * double(i)));
    pairs.g.push_back(g);
  }
  return pairs;
}

// Weights are (1 - eta)^n for the first value and eta (1 - eta)^(n - i) for the others, about the
// mean with equal weights.
double weighted_covariance(const Pairs& pairs, size_t count, double eta) {
  std::vector<double> weight(count);
  for (size_t i = 0; i < count; ++i)
    weight[i] = (i == 0 ? 1 : eta) * std::pow(1 - eta, double(count - 1 - i));
  double mean_f = 0, mean_g = 0, covariance = 0;
  for (size_t i = 0; i < count; ++i) {
    mean_f += weight[i] * pairs.f[i];
    mean_g += weight[i] * pairs.g[i];
  }
  for (size_t i = 0; i < count; ++i)
    covariance += weight[i] * (pairs.f[i] - mean_f) * (pairs.g[i] - mean_g);
  return covariance;
}

TEST(MovingMoments, CovarianceMatchesTheWeightedOne) {
  const Pairs pairs = random_pairs(600);
  for (const double eta : {0.5, 0.2, 0.05, 0.005, 1e-6}) {
    MovingCovariance moments;
    for (size_t i = 0; i < pairs.f.size(); ++i) {
      moments.add(pairs.f[i], pairs.g[i], eta);
      if (i != 1 && i != 10 && i + 1 != pairs.f.size()) continue;
      const double expected = weighted_covariance(pairs, i + 1, eta);
      EXPECT_NEAR(moments.covariance, expected, 1e-12 * std::abs(expected)) << eta << " " << i;
    }
  }
}

TEST(MovingMoments, OtherFormDiffersByAConstantFactor) {
  const Pairs pairs = random_pairs(400);
  for (const double eta : {0.5, 0.2, 0.05}) {
    MovingCovariance emc;
    WeightedCovariance ewma;
    for (size_t i = 0; i < pairs.f.size(); ++i) {
      emc.add(pairs.f[i], pairs.g[i], eta);
      ewma.add(pairs.f[i], pairs.g[i], eta);
      ASSERT_NEAR(ewma.covariance * (1 - eta), emc.covariance, 1e-12 * std::abs(emc.covariance))
          << eta << " " << i;
    }
  }
}

TEST(MovingMoments, IndependentValues_VarianceIsLowByAKnownFactor) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal(5, 2);
  constexpr int frames = 2000000, warm = 1000;
  for (const double eta : {0.2, 0.05}) {
    MovingVariance moving;
    double sum = 0;
    for (int i = 0; i < frames + warm; ++i) {
      moving.add(normal(random), eta);
      ASSERT_GE(moving.variance, 0);
      if (i >= warm) sum += moving.variance / frames;
    }
    // 4 sigma: the sd of one value is 0.48 of the mean (eta 0.2), correlated over about 2 / eta
    // frames.
    EXPECT_NEAR(sum / 4, 2 * (1 - eta) / (2 - eta), 0.003) << eta;
  }
}

TEST(MovingMoments, ConstantHasNoVariance) {
  for (const double value : {1e-6, 1.0, 1000.0}) {
    MovingVariance moving;
    for (int i = 0; i < 100; ++i)
      moving.add(value, 0.2);
    EXPECT_EQ(moving.variance, 0) << value;
  }
}

TEST(Guidance, VarianceOnTarget_KeepsTheSampleCount) {
  for (const double count : {8.0, 17.0, 64.0})
    for (const double kappa : {0.0, 0.2, 1.0})
      EXPECT_NEAR(required_samples(1e-4, count, {.kappa = kappa}), count, 1e-9);
}

TEST(Guidance, KappaOne_MatchesTheSlides) {
  const GuidanceSettings settings{.kappa = 1};
  for (const double variance : {2e-5, 1e-4, 3e-4}) {
    const double slides = 20 * (1 + (variance / 1e-4 - 1) * (2 / settings.eta - 1));
    EXPECT_NEAR(required_samples(variance, 20, settings), slides, 1e-9);
  }
}

TEST(Guidance, SampleCountIsAnIntegerInItsRange) {
  const GuidanceSettings settings;
  EXPECT_EQ(clamped_samples(-1e9, settings), 8);
  EXPECT_EQ(clamped_samples(1e9, settings), 64);
  EXPECT_EQ(clamped_samples(20.4, settings), 20);
}

TEST(Guidance, ControlWeightIsBoundedAndOneInTheDark) {
  EXPECT_EQ(control_weight({}, 1e-6), 1);
  MovingCovariance moments{
      .mean_f = 0.2, .mean_g = 0.1, .covariance = 1, .variance_g = 1e-9, .begun = true};
  EXPECT_NEAR(control_weight(moments, 1e-6), 3, 1e-12);
  moments.covariance = -1;
  EXPECT_EQ(control_weight(moments, 1e-6), 0);
  moments.covariance = 0.5e-3;
  moments.variance_g = 1e-3;
  EXPECT_NEAR(control_weight(moments, 1e-6), 0.5, 1e-3);
}

} // namespace
} // namespace dermis::subsurface
