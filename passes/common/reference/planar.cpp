#include "passes/common/reference/planar.hpp"

#include "passes/common/reference/fft.hpp"
#include "passes/common/reference/parallel.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>

namespace dermis::subsurface {

namespace {

// The bounding rectangle of all pixels of one profile.
struct Region {
  uint32_t x0 = UINT32_MAX, x1 = 0, y0 = UINT32_MAX, y1 = 0; // inclusive

  size_t width() const { return size_t{x1} - x0 + 1; }
  size_t height() const { return size_t{y1} - y0 + 1; }
};

bool is_surface(const ReferenceInput& input, size_t i) {
  return input.profile[i] != 0 && std::isfinite(input.depth[i]) && input.depth[i] > 0;
}

std::array<Region, 256> find_regions(const ReferenceInput& input) {
  std::array<Region, 256> regions{};
  for (uint32_t y = 0; y < input.height; ++y)
    for (uint32_t x = 0; x < input.width; ++x) {
      const size_t i = size_t{y} * input.width + x;
      if (!is_surface(input, i)) continue;
      Region& r = regions[input.profile[i]];
      r = {std::min(r.x0, x), std::max(r.x1, x), std::min(r.y0, y), std::max(r.y1, y)};
    }
  return regions;
}

// One convolution computes light and mask, as real and imaginary part with a real kernel.
void convolve_channel(const ReferenceInput& input, const Region& region, uint8_t id, size_t channel,
                      double direct, const std::vector<PerChannel>& quadrant, size_t reach_x,
                      size_t reach_y, unsigned threads, std::vector<double>& result) {
  ComplexImage image{power_of_two_from(region.width() + reach_x),
                     power_of_two_from(region.height() + reach_y),
                     {}};
  image.values.resize(image.width * image.height);
  ComplexImage kernel = image;
  auto each_pixel = [&](auto&& act) {
    for (size_t y = 0; y < region.height(); ++y)
      for (size_t x = 0; x < region.width(); ++x) {
        const size_t i = (region.y0 + y) * input.width + region.x0 + x;
        if (is_surface(input, i) && input.profile[i] == id)
          act(i, image.values[y * image.width + x]);
      }
  };
  double minimum = std::numeric_limits<double>::infinity(), maximum = -minimum;
  each_pixel([&](size_t i, std::complex<double>& value) {
    value = {input.light[3 * i + channel], 1.0};
    minimum = std::min(minimum, value.real());
    maximum = std::max(maximum, value.real());
  });
  for (size_t y = 0; y <= reach_y; ++y)
    for (size_t x = 0; x <= reach_x; ++x) {
      const double weight = quadrant[y * (reach_x + 1) + x][channel];
      for (const size_t row : {y, (image.height - y) % image.height})
        for (const size_t column : {x, (image.width - x) % image.width})
          kernel.values[row * image.width + column] = weight;
    }
  fft_forward(image, threads);
  fft_forward(kernel, threads);
  for (size_t i = 0; i < image.values.size(); ++i)
    image.values[i] *= kernel.values[i].real();
  fft_inverse(image, threads);
  each_pixel([&](size_t i, const std::complex<double>& value) {
    // The pixel itself counts, so the mask's weight is positive.
    double& light = result[3 * i + channel];
    // A weighted mean of light is within the range of all light; rounding of the FFT may leave it.
    light += (1 - direct) * (std::clamp(value.real() / value.imag(), minimum, maximum) - light);
  });
}

} // namespace

double half_pixel_diagonal(const PixelRays& rays, double depth) {
  return 0.5 * std::hypot(rays.scale_x, rays.scale_y) * (rays.perspective ? depth : 1);
}

PerChannel planar_weight(double pitch_x, double pitch_y, int64_t dx, int64_t dy,
                         const PerChannel& d) {
  const ProfileShape shape = burley_shapes(d);
  const double radius = reach_of(shape) + 0.5 * std::hypot(pitch_x, pitch_y);
  return planar_weight(pitch_x, pitch_y, dx, dy, shape, radius);
}

PerChannel planar_weight(double pitch_x, double pitch_y, int64_t dx, int64_t dy,
                         const ProfileShape& shape, double radius) {
  const PixelRays rays{
      .scale_x = pitch_x, .offset_x = 0, .scale_y = -pitch_y, .offset_y = 0, .perspective = false};
  const double x = double(dx), y = double(dy), area = pitch_x * pitch_y;
  const Patch patch{pixel_position(rays, x, y, 0), {0, 0, 1}, area};
  if (dx == 0 && dy == 0) return centre_integral(rays, patch, 0, 0, shape);
  if (length(patch.position) > radius) return {};
  PerChannel weight = patch_mean(
      rays, patch, x, y, std::max(std::abs(dx), std::abs(dy)) <= near_pixels, {0, 0, 0}, shape);
  for (double& w : weight)
    w *= area;
  return weight;
}

bool is_planar(const ReferenceInput& input) {
  if (input.rays.perspective || !input.scatter_scale.empty()) return false;
  std::array<float, 256> depth{};
  for (size_t i = 0; i < input.profile.size(); ++i) {
    if (!is_surface(input, i)) continue;
    float& known = depth[input.profile[i]];
    if (known == 0) known = input.depth[i];
    if (known != input.depth[i]) return false;
  }
  return true;
}

std::vector<double> planar_reference(const ReferenceInput& input, unsigned threads) {
  std::vector<double> result(input.light.begin(), input.light.end());
  const std::array<Region, 256> regions = find_regions(input);
  const double pitch_x = std::abs(input.rays.scale_x), pitch_y = std::abs(input.rays.scale_y);
  for (size_t id = 1; id < std::min(regions.size(), input.d_m.size()); ++id) {
    const Region& region = regions[id];
    const ProfileShape shape = input.shape_of(id);
    if (region.x0 > region.x1 || !(std::max({shape[0].d, shape[1].d, shape[2].d}) > 0)) continue;
    const double radius = reach_of(shape) + half_pixel_diagonal(input.rays, 1);
    const auto reach_x =
        static_cast<size_t>(std::min(radius / pitch_x, double(region.width() - 1)));
    const auto reach_y =
        static_cast<size_t>(std::min(radius / pitch_y, double(region.height() - 1)));
    std::vector<PerChannel> quadrant((reach_x + 1) * (reach_y + 1));
    parallel_for(quadrant.size(), 256, threads, [&](size_t i) {
      quadrant[i] = planar_weight(pitch_x, pitch_y, static_cast<int64_t>(i % (reach_x + 1)),
                                  static_cast<int64_t>(i / (reach_x + 1)), shape, radius);
    });
    for (size_t c = 0; c < 3; ++c)
      if (shape[c].d > 0)
        convolve_channel(input, region, static_cast<uint8_t>(id), c, shape[c].direct, quadrant,
                         reach_x, reach_y, threads, result);
  }
  return result;
}

} // namespace dermis::subsurface
