// What holds of samples: means, their bias and how errors fall with their number.
#include "tests/laws/plane.hpp"

#include "passes/subsurface/truth/planar.hpp"
#include "passes/subsurface/truth/truth.hpp"

#include <cmath>

namespace {

using namespace laws;
namespace sss = dermis::subsurface;

// Light without order: an integer hash of the pixel (a power of two below 1, exact in fp16).
float noise(double x, double y) {
  uint32_t h = static_cast<uint32_t>(x) * 374761393u + static_cast<uint32_t>(y) * 668265263u;
  h = (h ^ (h >> 13)) * 1274126177u;
  return static_cast<float>((h ^ (h >> 16)) & 255u) / 256.0f;
}

Plane noisy_plane(uint32_t side, double d) {
  Plane plane;
  plane.width = plane.height = side;
  plane.d_px = {d, 0.38 * d, 0.19 * d};
  plane.light = noise;
  return plane;
}

// Sum of kernel times light over the picture, without dividing by the kernel's share inside of it. What is
// beyond the cut (20 d) holds below .1 % of the kernel.
std::vector<double> unnormalised_truth(const Plane& plane) {
  const int side = static_cast<int>(plane.width);
  std::vector<sss::PerChannel> kernel(size_t(side) * size_t(side));
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x)
      kernel[size_t(y * side + x)] = sss::planar_weight(
          1, 1, x, y, sss::burley_shapes({plane.d_px[0], plane.d_px[1], plane.d_px[2]}), 1e3);
  std::vector<double> truth(3 * kernel.size());
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x)
      for (int v = 0; v < side; ++v)
        for (int u = 0; u < side; ++u)
          for (size_t c = 0; c < 3; ++c)
            truth[3 * size_t(y * side + x) + c] +=
                kernel[size_t(std::abs(v - y) * side + std::abs(u - x))][c] * double(noise(u, v));
  return truth;
}

// Sums over frames of each value and of its square.
struct Moments {
  std::vector<double> sum, square;
  uint32_t frames = 0;

  double mean(size_t i) const { return sum[i] / frames; }
  double variance_of_mean(size_t i) const { return (square[i] / frames - mean(i) * mean(i)) / (frames - 1); }
};

Moments accumulate(const Plane& plane, const Settings& settings, uint32_t frames) {
  Moments moments;
  const size_t values = size_t{3} * plane.width * plane.height;
  moments.sum.resize(values);
  moments.square.resize(values);
  run_frames("fixed", plane, settings, frames, [&](const Picture& picture) {
    for (size_t i = 0; i < values; ++i) {
      const double v = static_cast<double>(picture.rgb[i]);
      moments.sum[i] += v;
      moments.square[i] += v * v;
    }
    ++moments.frames;
  });
  return moments;
}

class Sampler : public DeviceTest {};

TEST_F(Sampler, TheMeanOfManyFramesIsTheTruthAtEveryPixel) {
  // 8 x 8 copies of one small picture, 50 d apart in depth and each with hashes of its own, over 64 frames:
  // 4096 independent frames of it.
  constexpr uint32_t side = 12, copies = 8, frames = 64;
  constexpr double n = copies * copies * frames;
  const Plane small = noisy_plane(side, 1.0);
  const std::vector<double> truth = unnormalised_truth(small);
  Plane plane = small;
  plane.width = plane.height = side * copies;
  const auto at = [](int v) { return static_cast<uint32_t>(v) / side; };
  plane.depth_m = [&](int x, int y) { return 1.0f + 0.05f * static_cast<float>(at(y) * copies + at(x)); };
  plane.light = [](double x, double y) { return noise(std::fmod(x, side), std::fmod(y, side)); };
  std::vector<double> sum(truth.size()), square(truth.size());
  run_frames("fixed", plane, {{"samples", "4"}, {"normalise", "\"none\""}, {"inverse", "\"exact\""}}, frames,
             [&](const Picture& picture) {
               for (uint32_t y = 0; y < plane.height; ++y)
                 for (uint32_t x = 0; x < plane.width; ++x)
                   for (uint32_t c = 0; c < 3; ++c) {
                     const size_t i = 3 * (size_t{y % side} * side + x % side) + c;
                     const double value = picture.at(x, y, c);
                     sum[i] += value / n;
                     square[i] += value * value / n;
                   }
             });
  double z_square = 0;
  for (size_t i = 0; i < truth.size(); ++i) {
    const double z = (sum[i] - truth[i]) / std::sqrt((square[i] - sum[i] * sum[i]) / (n - 1));
    EXPECT_LT(std::abs(z), 4) << "value " << i; // of 432 values .03 beyond 4 sigma are expected
    z_square += z * z / double(truth.size());
  }
  EXPECT_NEAR(z_square, 1, 0.36); // 144 independent pixels, three alike channels: sd .12
}

// How far the mean of a picture is from the truth along the direction from the light to the truth, in sigmas
// of the frames' scatter and as a share: positive where too much of the own light is kept.
struct Bias {
  double share = 0, sigmas = 0;
};

Bias bias_of(const Plane& plane, const std::vector<double>& truth, const Settings& settings, uint32_t frames,
             uint32_t channel = 0) {
  double numerator = 0, denominator = 0, variance = 0;
  const Moments moments = accumulate(plane, settings, frames);
  for (uint32_t y = 0; y < plane.height; ++y)
    for (uint32_t x = 0; x < plane.width; ++x) {
      const size_t i = 3 * (size_t{y} * plane.width + x) + channel;
      const double way = double(noise(x, y)) - truth[i];
      numerator += way * (moments.mean(i) - truth[i]);
      denominator += way * way;
      variance += way * way * moments.variance_of_mean(i);
    }
  return {numerator / denominator, numerator / std::sqrt(variance)};
}

TEST_F(Sampler, EveryInverseWithItsOwnDensityIsUnbiasedAndThePublishedChoicesAreNot) {
  const Plane plane = noisy_plane(40, 0.5);
  const std::vector<double> truth = unnormalised_truth(plane);
  const auto bias = [&](const char* inverse, const char* weighting, const char* direct) {
    return bias_of(plane, truth,
                   {{"samples", "8"},
                    {"normalise", "\"none\""},
                    {"inverse", inverse},
                    {"weighting", weighting},
                    {"direct", direct}},
                   64);
  };
  for (const char* inverse : {"\"polynomial\"", "\"exact\"", "\"approximate\""})
    for (const char* direct : {"\"inscribed\"", "\"none\""}) {
      const Bias one = bias(inverse, "\"sampler\"", direct);
      EXPECT_LT(std::abs(one.sigmas), 3.5) << inverse << " " << direct << ": " << one.share;
    }
  const Bias radius = bias("\"exact\"", "\"sampler\"", "\"circumscribed\"");
  EXPECT_GT(radius.sigmas, 10) << radius.share; // the neighbours' share of the corners becomes the own light
  EXPECT_GT(radius.share, 0.01);
}

// The truth as it is defined: divided by the kernel's share inside of the picture.
std::vector<double> normalised_truth(const Plane& plane) {
  const size_t pixels = size_t{plane.width} * plane.height;
  std::vector<float> light;
  for (size_t i = 0; i < pixels; ++i)
    light.insert(light.end(), 3, noise(double(i % plane.width), double(i / plane.width)));
  const std::vector<float> depth(pixels, 1.0f);
  const std::vector<uint8_t> profile(pixels, 1);
  const std::vector<sss::PerChannel> d_m = {
      {}, {plane.d_px[0] * 1e-3, plane.d_px[1] * 1e-3, plane.d_px[2] * 1e-3}};
  return sss::truth_everywhere({.width = plane.width,
                                .height = plane.height,
                                .rays = sss::orthographic_rays(plane.width, plane.height, 1e-3),
                                .light = light,
                                .depth = depth,
                                .profile = profile,
                                .scatter_scale = {},
                                .d_m = d_m});
}

TEST_F(Sampler, SelfNormalisationHasABiasThatFallsWithTheNumberOfSamples) {
  // In a narrow channel weights vary, so that the ratio of two means is off by about their covariance over n.
  const Plane plane = noisy_plane(48, 4.0);
  const std::vector<double> truth = normalised_truth(plane);
  double before = 1, first = 0;
  for (const char* samples : {"4", "16", "64"}) {
    const Bias one = bias_of(plane, truth, {{"samples", samples}, {"direct", "\"none\""}}, 64, 2);
    RecordProperty(std::string("share_at_") + samples, std::to_string(one.share));
    RecordProperty(std::string("sigmas_at_") + samples, std::to_string(one.sigmas));
    EXPECT_LT(std::abs(one.share), before) << samples << " samples";
    before = std::abs(one.share);
    if (first == 0) first = before;
  }
  EXPECT_LT(before, 0.15 * first); // 1/16 is expected
}

TEST_F(Sampler, TheErrorFallsFasterThanThatOfIndependentSamples) {
  // Independent samples: n^-.5. R2 on light with edges: about n^-.7 over 8 to 64.
  Plane plane;
  plane.width = plane.height = 192;
  plane.d_px = {3, 3, 3};
  plane.light = [](double x, double y) {
    return (x < 96 ? 0.2f : 0.8f) + (std::hypot(x - 60, y - 80) < 25 ? 0.2f : 0.0f);
  };
  std::vector<double> logs;
  std::vector<float> truth;
  {
    const Picture many = run("fixed", plane, {{"samples", "4096"}});
    truth = many.rgb;
  }
  for (const char* samples : {"8", "16", "32", "64"}) {
    const Picture picture = run("fixed", plane, {{"samples", samples}});
    double squares = 0;
    for (size_t i = 0; i < truth.size(); i += 3)
      squares += std::pow(double(picture.rgb[i]) - double(truth[i]), 2);
    logs.push_back(0.5 * std::log2(squares / double(truth.size() / 3)));
  }
  // Least squares over four points one octave apart.
  const double slope = (3 * (logs[3] - logs[0]) + (logs[2] - logs[1])) / 10;
  RecordProperty("slope", std::to_string(slope));
  EXPECT_LT(slope, -0.6);
  EXPECT_GT(slope, -0.9);
}

} // namespace
