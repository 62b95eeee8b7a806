// Tests or measures statements of the papers that no kernel needs; docs/papers.md names the
// statements by their ids.
#include "integration/tools/references/guidance.hpp"
#include "passes/common/profiles/burley_profile.hpp"
#include "passes/common/profiles/shape.hpp"
#include "tests/passes/common/cpu/sequence.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <numbers>
#include <random>
#include <set>
#include <tuple>
#include <vector>

namespace dermis::subsurface {
namespace {

// A5: a ring of the sample counts of the last k frames. The sum follows the variance of the mean
// over these frames: sum_i = sum_(i - 1) variance / target, and n_i is the newly added count.
class RingOfSamples {
public:
  RingOfSamples(size_t k, double first) : counts_(k, first), sum_(first * double(k)) {}

  double next(double variance, double target) {
    const double required = sum_ * variance / target, oldest = counts_.front();
    const double count = required - sum_ + oldest;
    counts_.pop_front();
    counts_.push_back(count);
    sum_ = required;
    return count;
  }
  double mean() const { return sum_ / double(counts_.size()); }

private:
  std::deque<double> counts_;
  double sum_;
};

// Not clamped: both forms may request negative counts while they settle.
TEST(SampleRing, ShortForm_MatchesInFirstFrameAndMean) {
  constexpr double eta = 0.2, target = 1e-4,
                   one_sample = 2.4e-3; // Variance of a single sample: 24 samples are needed.
  constexpr size_t k = 9;               // 2 / eta - 1 (slide 24)
  GuidanceSettings settings;
  settings.kappa = 1; // The short form of the slides.
  settings.eta = eta;
  settings.sigma2_target = target;
  for (const double first : {8.0, 24.0, 40.0}) {
    RingOfSamples ring(k, first);
    double moving = first, ring_sum = 0, short_sum = 0;
    constexpr int settle = 90, frames = 900;
    for (int i = 0; i < settle + frames; ++i) {
      const double by_ring = ring.next(one_sample / ring.mean(), target);
      const double by_mean = required_samples(one_sample / moving, moving, settings);
      moving += eta * (by_mean - moving);
      if (i == 0) {
        EXPECT_NEAR(by_ring, by_mean, 1e-9) << first;
      }
      if (i < settle) continue;
      ring_sum += by_ring / frames;
      short_sum += by_mean / frames;
    }
    // The ring repeats its first frames forever; the short form forgets them.
    EXPECT_NEAR(ring_sum, 24, 1e-6) << first;
    EXPECT_NEAR(short_sum, 24, 1e-6) << first;
  }
}

// C7: one factor of any value scales all earlier weights; the new weight is w.
TEST(MovingMoments, VaryingWeights_MatchTheWeightedCovariance) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> uniform(0.05, 1);
  std::normal_distribution<double> normal;
  std::vector<double> weights, xs, ys;
  double total = 0, mean_x = 0, mean_y = 0, sum = 0;
  for (int n = 0; n < 200; ++n) {
    const double w = uniform(random), factor = uniform(random), x = 3 + normal(random),
                 y = x + normal(random);
    for (double& one : weights)
      one *= factor;
    weights.push_back(w);
    xs.push_back(x);
    ys.push_back(y);
    const double before = total;
    total = factor * before + w;
    const double old_mean_x = mean_x;
    mean_x += w / total * (x - mean_x);
    mean_y += w / total * (y - mean_y);
    // Supplement, equation 17.
    if (n > 0) sum = (total - w) / before * sum + w * (y - mean_y) * (x - old_mean_x);
    double expected = 0;
    for (size_t i = 0; i < weights.size(); ++i)
      expected += weights[i] * (xs[i] - mean_x) * (ys[i] - mean_y);
    EXPECT_NEAR(sum, expected, 1e-12 * std::max(1.0, std::abs(expected))) << n;
  }
}

// C8: Cov(mean X, mean Y) = Cov(X, Y) / n, so the control's weight can be computed from frame
// means.
TEST(BatchMeans, CovarianceIsOneSamplesOverTheirNumber) {
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal;
  for (const int n : {1, 4, 16}) {
    constexpr int batches = 100000;
    double sum_x = 0, sum_y = 0, sum_xy = 0;
    for (int b = 0; b < batches; ++b) {
      double mean_x = 0, mean_y = 0;
      for (int i = 0; i < n; ++i) {
        // Covariance 0.6, variances 1.
        const double x = normal(random), y = 0.6 * x + 0.8 * normal(random);
        mean_x += x / n;
        mean_y += y / n;
      }
      sum_x += mean_x / batches;
      sum_y += mean_y / batches;
      sum_xy += mean_x * mean_y / batches;
    }
    // The product of two such normals has variance (1 + 0.6^2) / n^2; the bound is four standard
    // errors.
    EXPECT_NEAR((sum_xy - sum_x * sum_y) * n, 0.6, 4 * std::sqrt(1.36 / batches)) << n;
  }
}

// C9: A_t = diag(Sigma_t)^-1 Sigma_t; its element in the control's row is the control's weight.
TEST(MovingMoments, TheMatrixFormHoldsTheControlsWeight) {
  std::mt19937_64 random(23);
  std::normal_distribution<double> normal;
  constexpr double eta = 0.05;
  MovingCovariance moments;
  std::array<double, 2> mean{};
  std::array<std::array<double, 2>, 2> sigma{};
  for (int t = 0; t < 300; ++t) {
    const double g = 1 + 0.3 * normal(random), f = 0.7 * g + 0.1 * normal(random) + 1;
    const std::array<double, 2> z = {f, g};
    if (t == 0) mean = z;
    for (size_t r = 0; r < 2; ++r) // Equation 33, with the means of the previous frame.
      for (size_t c = 0; c < 2; ++c)
        sigma[r][c] =
            (1 - eta) * sigma[r][c] + eta * (1 - eta) * (z[r] - mean[r]) * (z[c] - mean[c]);
    for (size_t r = 0; r < 2; ++r)
      mean[r] = (1 - eta) * mean[r] + eta * z[r];
    moments.add(f, g, eta);
    if (t < 2) continue;
    const double of_the_matrix = sigma[1][0] / sigma[1][1];
    EXPECT_NEAR(control_weight(moments, 0),
                std::clamp(of_the_matrix, 0.0, (mean[0] + mean[1]) / mean[1]), 1e-11)
        << t;
  }
}

// Returns light scattered from beyond r0 to a point at x from the edge of a lit half plane (x < 0).
double scattered_at(const ChannelShape& shape, double x, double r0) {
  constexpr int steps = 20000;
  const double from = std::log(std::max(r0, 1e-6)), to = std::log(400 * shape.d);
  double sum = 0, total = 0;
  for (int i = 0; i < steps; ++i) {
    const double r = std::exp(from + (to - from) * (i + 0.5) / steps);
    const double lit = r < std::abs(x) ? (x < 0 ? 1 : 0)
                                       : std::acos(std::clamp(x / r, -1.0, 1.0)) / std::numbers::pi;
    const double weight = shape_pdf(shape, r) * r;
    sum += weight * lit;
    total += weight;
  }
  return sum / total;
}

// T14, equation 17: the artist's fraction that makes his form agree with the dipole's form. The
// fraction depends on the light and so cannot be a constant of a profile: at an edge it differs at
// each distance.
TEST(ArtistFraction, MatchingTheDipoleDependsOnThePlace) {
  const ChannelShape dipole = dipole_shape(0.032, 0.74), artist = artist_shape(1.001, 1);
  constexpr double r0 = 0.25; // mm
  const double gamma = shape_gamma(dipole, r0);
  double minimum = 1e9, maximum = -1e9;
  for (const double x : {-8.0, -4.0, -2.0, -1.0, -0.5, 0.5, 1.0, 2.0, 4.0, 8.0}) {
    const double own = x < 0 ? 1 : 0;
    const double by_dipole = scattered_at(dipole, x, r0), by_artist = scattered_at(artist, x, 0);
    const double fraction = gamma * (own - by_dipole) / (own - by_artist);
    const double theirs = (1 - gamma) * own + gamma * by_dipole,
                 his = (1 - fraction) * own + fraction * by_artist;
    EXPECT_NEAR(his, theirs, 1e-5) << x;
    minimum = std::min(minimum, fraction);
    maximum = std::max(maximum, fraction);
  }
  RecordProperty("least", std::to_string(minimum));
  RecordProperty("greatest", std::to_string(maximum));
  EXPECT_GT(maximum, 2 * minimum);
}

// F7: counts lines of 128 bytes (16 texels of 8 bytes) that an 8x8 tile of a plane reads, each
// once: the minimum traffic of any cache. Samples lie beyond the inscribed radius and read two
// levels of the chain as afis does.
size_t lines_of_a_tile(int samples, double d, double bias) {
  std::set<std::tuple<int, int, int>> lines; // Level, row, group of 16.
  constexpr double r0 = 0.5;
  const double beyond = 1 - burley_cdf(r0, d);
  const auto touch = [&](int level, double x, double y) {
    const double scale = std::exp2(-level), u = (x + 0.5) * scale - 0.5,
                 v = (y + 0.5) * scale - 0.5;
    const int taps = level == 0 ? 1 : 2; // Bilinear above level 0.
    for (int j = 0; j < taps; ++j)
      for (int i = 0; i < taps; ++i) {
        const int column = int(level == 0 ? std::lround(x) : std::floor(u)) + i;
        const int row = int(level == 0 ? std::lround(y) : std::floor(v)) + j;
        lines.insert({level, row, int(std::floor(column / 16.0))});
      }
  };
  for (uint32_t y = 0; y < 8; ++y)
    for (uint32_t x = 0; x < 8; ++x) {
      const auto hash = pcg3d16({x, y, 0});
      for (int i = 0; i < samples; ++i) {
        const auto point =
            r2_point({offset_from_hash(hash[0]), offset_from_hash(hash[1])}, uint32_t(i));
        const double xi = point[0] * 0x1p-32, angle = 2 * std::numbers::pi * point[1] * 0x1p-32;
        const double r = burley_inverse_survival(beyond * (1 - xi), d);
        const double density = burley_pdf(r, d) / (2 * std::numbers::pi * r * beyond);
        const double lod = std::clamp(0.5 * std::log2(1 / (samples * density)) + bias, 0.0, 8.0);
        const double at_x = 1000 + x + r * std::cos(angle), at_y = 1000 + y + r * std::sin(angle);
        touch(int(lod), at_x, at_y);
        if (lod > int(lod)) touch(int(lod) + 1, at_x, at_y);
      }
    }
  return lines.size();
}

TEST(CacheLines, FewerSamplesReadFewerLines) {
  constexpr double d = 4;
  const size_t adaptive = lines_of_a_tile(16, d, -1), fixed = lines_of_a_tile(64, d, -1);
  RecordProperty("n_16", std::to_string(adaptive));
  RecordProperty("n_64", std::to_string(fixed));
  RecordProperty("n_64_without_mips", std::to_string(lines_of_a_tile(64, d, -20)));
  // Slides 29 to 31 report 39.5 % fewer misses at the finest level in a simulator, adaptive against
  // fixed.
  EXPECT_LT(double(adaptive), 0.8 * double(fixed));
}

} // namespace
} // namespace dermis::subsurface
