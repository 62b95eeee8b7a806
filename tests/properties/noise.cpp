#include "tests/properties/noise.hpp"

#include "passes/common/reference/planar.hpp"
#include "passes/common/reference/reference.hpp"

#include <cmath>

namespace properties {

namespace sss = dermis::subsurface;

float noise(double x, double y) {
  uint32_t h = static_cast<uint32_t>(x) * 374761393u + static_cast<uint32_t>(y) * 668265263u;
  h = (h ^ (h >> 13)) * 1274126177u;
  return static_cast<float>((h ^ (h >> 16)) & 255u) / 256.0f;
}

Plane noisy_plane(uint32_t side, double d) {
  Plane plane{.width = side, .height = side, .d_px = {d, 0.38 * d, 0.19 * d}};
  plane.light = noise;
  return plane;
}

std::vector<double> unnormalised_reference(const Plane& plane) {
  const int side = static_cast<int>(plane.width);
  std::vector<sss::PerChannel> kernel(size_t(side) * size_t(side));
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x)
      kernel[size_t(y * side + x)] = sss::planar_weight(
          1, 1, x, y, sss::burley_shapes({plane.d_px[0], plane.d_px[1], plane.d_px[2]}), 1e3);
  std::vector<double> reference(3 * kernel.size());
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x)
      for (int v = 0; v < side; ++v)
        for (int u = 0; u < side; ++u)
          for (size_t c = 0; c < 3; ++c)
            reference[3 * size_t(y * side + x) + c] +=
                kernel[size_t(std::abs(v - y) * side + std::abs(u - x))][c] * double(noise(u, v));
  return reference;
}

std::vector<double> normalised_reference(const Plane& plane) {
  const size_t pixels = size_t{plane.width} * plane.height;
  std::vector<float> light;
  for (size_t i = 0; i < pixels; ++i)
    light.insert(light.end(), 3, noise(double(i % plane.width), double(i / plane.width)));
  const std::vector<float> depth(pixels, 1.0f);
  const std::vector<uint8_t> profile(pixels, 1);
  const std::vector<sss::PerChannel> d_m = {
      {}, {plane.d_px[0] * 1e-3, plane.d_px[1] * 1e-3, plane.d_px[2] * 1e-3}};
  return sss::reference_everywhere({.width = plane.width,
                                    .height = plane.height,
                                    .rays = sss::orthographic_rays(plane.width, plane.height, 1e-3),
                                    .light = light,
                                    .depth = depth,
                                    .profile = profile,
                                    .scatter_scale = {},
                                    .d_m = d_m});
}

namespace {

// Sums over frames of each value and of its square.
struct Moments {
  std::vector<double> sum, square;
  uint32_t frames = 0;

  double mean(size_t i) const { return sum[i] / frames; }
  double variance_of_mean(size_t i) const {
    return (square[i] / frames - mean(i) * mean(i)) / (frames - 1);
  }
};

Moments accumulate(const std::string& graph, const Plane& plane, const Settings& settings,
                   uint32_t frames) {
  Moments moments;
  const size_t values = size_t{3} * plane.width * plane.height;
  moments.sum.resize(values);
  moments.square.resize(values);
  run_frames(graph, plane, settings, frames, [&](const Picture& picture) {
    for (size_t i = 0; i < values; ++i) {
      const double v = static_cast<double>(picture.rgb[i]);
      moments.sum[i] += v;
      moments.square[i] += v * v;
    }
    ++moments.frames;
  });
  return moments;
}

} // namespace

Bias bias_of(const std::string& graph, const Plane& plane, const std::vector<double>& reference,
             const Settings& settings, uint32_t frames, uint32_t channel) {
  double numerator = 0, denominator = 0, variance = 0, squares = 0;
  const Moments moments = accumulate(graph, plane, settings, frames);
  for (uint32_t y = 0; y < plane.height; ++y)
    for (uint32_t x = 0; x < plane.width; ++x) {
      const size_t i = 3 * (size_t{y} * plane.width + x) + channel;
      const double way = double(noise(x, y)) - reference[i];
      numerator += way * (moments.mean(i) - reference[i]);
      denominator += way * way;
      squares += moments.square[i] / frames - 2 * moments.mean(i) * reference[i] +
                 reference[i] * reference[i];
      variance += way * way * moments.variance_of_mean(i);
    }
  return {numerator / denominator, numerator / std::sqrt(variance),
          std::sqrt(squares / (double(plane.width) * plane.height))};
}

double expect_the_reference_in_the_mean(const std::string& graph, const Settings& settings) {
  // 8 x 8 copies of a small picture, 50 d apart in depth with separate hashes, over 64 frames: 4096
  // independent frames.
  constexpr uint32_t side = 12, copies = 8, frames = 64;
  constexpr double n = copies * copies * frames;
  const Plane small = noisy_plane(side, 1.0);
  const std::vector<double> reference = unnormalised_reference(small);
  Plane plane = small;
  plane.width = plane.height = side * copies;
  const auto at = [](int v) { return static_cast<uint32_t>(v) / side; };
  plane.depth_m = [&](int x, int y) {
    return 1.0f + 0.05f * static_cast<float>(at(y) * copies + at(x));
  };
  plane.light = [](double x, double y) { return noise(std::fmod(x, side), std::fmod(y, side)); };
  std::vector<double> sum(reference.size()), square(reference.size());
  run_frames(graph, plane, settings, frames, [&](const Picture& picture) {
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
  for (size_t i = 0; i < reference.size(); ++i) {
    const double z = (sum[i] - reference[i]) / std::sqrt((square[i] - sum[i] * sum[i]) / (n - 1));
    EXPECT_LT(std::abs(z), 4) << "value " << i; // 0.03 of 432 values are expected beyond 4 sigma.
    z_square += z * z / double(reference.size());
  }
  return z_square; // 144 independent pixels with three equal channels: sd 0.12.
}

} // namespace properties
