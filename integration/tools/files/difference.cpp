#include "integration/tools/files/difference.hpp"

#include "integration/tools/files/metrics.hpp"
#include "integration/tools/files/png.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace dermis::tools {
namespace {

constexpr int radius = 5; // radius of the SSIM window, pixels
constexpr double sigma = 1.5;
constexpr double c1 = 0.01 * 0.01, c2 = 0.03 * 0.03; // K1 and K2 of Wang et al. 2004, peak 1

std::array<double, 2 * radius + 1> window() {
  std::array<double, 2 * radius + 1> weights{};
  double sum = 0;
  for (int i = -radius; i <= radius; ++i)
    sum += weights[static_cast<size_t>(i + radius)] = std::exp(-i * i / (2 * sigma * sigma));
  for (double& weight : weights)
    weight /= sum;
  return weights;
}

using Plane = std::vector<double>;

// Separable Gaussian. The window is cut at borders and its weights are renormalised.
Plane blurred(const Plane& plane, uint32_t width, uint32_t height) {
  static const auto weights = window();
  const auto pass = [&](const Plane& from, uint32_t along, uint32_t across, size_t step,
                        size_t stride) {
    Plane to(from.size());
    for (uint32_t line = 0; line < across; ++line)
      for (uint32_t i = 0; i < along; ++i) {
        double sum = 0, weight = 0;
        const int first = std::max(-radius, -static_cast<int>(i));
        const int last = std::min(radius, static_cast<int>(along - 1 - i));
        for (int k = first; k <= last; ++k) {
          const double w = weights[static_cast<size_t>(k + radius)];
          sum += w * from[line * stride + static_cast<size_t>(static_cast<int>(i) + k) * step];
          weight += w;
        }
        to[line * stride + i * step] = sum / weight;
      }
    return to;
  };
  return pass(pass(plane, width, height, 1, width), height, width, width, 1);
}

Plane product(const Plane& a, const Plane& b) {
  Plane out(a.size());
  std::transform(a.begin(), a.end(), b.begin(), out.begin(), std::multiplies<>());
  return out;
}

double mean_ssim(const Plane& a, const Plane& b, uint32_t width, uint32_t height) {
  const Plane ma = blurred(a, width, height), mb = blurred(b, width, height);
  const Plane aa = blurred(product(a, a), width, height),
              bb = blurred(product(b, b), width, height);
  const Plane ab = blurred(product(a, b), width, height);
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    const double variances = aa[i] - ma[i] * ma[i] + bb[i] - mb[i] * mb[i],
                 covariance = ab[i] - ma[i] * mb[i];
    sum += (2 * ma[i] * mb[i] + c1) * (2 * covariance + c2) /
           ((ma[i] * ma[i] + mb[i] * mb[i] + c1) * (variances + c2));
  }
  return sum / static_cast<double>(a.size());
}

} // namespace

Image encoded(const Image& linear) {
  Image out = linear;
  for (float& value : out.values)
    value = srgb_encode(value);
  return out;
}

Image exposed_luminance(const Image& light, double exposure) {
  Image out = Image::sized(light.width, light.height, 1);
  for (size_t i = 0; i < out.values.size(); ++i) {
    const float* texel = &light.values[i * light.channels];
    const double value = light.channels >= 3 ? luminance_of(texel) : double(*texel);
    out.values[i] = static_cast<float>(value * exposure);
  }
  return out;
}

double exposure_of(const Image& light, const Image* mask) {
  const Image plain = exposed_luminance(light, 1);
  ExposureMeter meter;
  for (size_t i = 0; i < plain.values.size(); ++i)
    if (std::isfinite(plain.values[i]) && plain.values[i] > 0 &&
        (mask == nullptr || mask->values[i] != 0))
      meter.luminance.push_back(plain.values[i]);
  return meter.result();
}

Difference compare_pictures(const Image& a, const Image& b, const PixelRectangle& where,
                            const Image* mask) {
  Difference difference;
  const auto left_out = [&](uint32_t x, uint32_t y) {
    return mask != nullptr && mask->at(where.x + x, where.y + y, 0) == 0;
  };
  double squares = 0, ssim = 0;
  std::vector<bool> counted(size_t{where.width} * where.height, false);
  for (uint32_t c = 0; c < a.channels; ++c) {
    Plane pa, pb;
    for (uint32_t y = 0; y < where.height; ++y)
      for (uint32_t x = 0; x < where.width; ++x) {
        if (left_out(x, y)) continue;
        if (c == 0) ++difference.pixels;
        double va = double(a.at(where.x + x, where.y + y, c)),
               vb = double(b.at(where.x + x, where.y + y, c));
        const size_t pixel = size_t{y} * where.width + x;
        if (!std::isfinite(va) || !std::isfinite(vb)) {
          difference.nonfinite += counted[pixel] ? 0 : 1;
          counted[pixel] = true;
          va = 0;
          vb = 1;
        }
        const double error = std::abs(va - vb);
        squares += error * error;
        if (error > difference.max_error) {
          difference.max_error = error;
          difference.worst_x = where.x + x;
          difference.worst_y = where.y + y;
        }
        pa.push_back(va);
        pb.push_back(vb);
      }
    if (mask == nullptr) ssim += mean_ssim(pa, pb, where.width, where.height) / a.channels;
  }
  const double mse = squares / std::max(1.0, static_cast<double>(difference.pixels) * a.channels);
  difference.rmse = std::sqrt(mse);
  difference.psnr_db = psnr_from_mse(mse);
  if (mask == nullptr) difference.ssim = ssim;
  return difference;
}

} // namespace dermis::tools
