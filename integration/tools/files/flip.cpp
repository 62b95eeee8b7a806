#include "integration/tools/files/flip.hpp"

#include "integration/tools/files/metrics.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace dermis::tools {
namespace {

using Color = std::array<double, 3>;
using Plane = std::vector<double>;
using Planes = std::array<Plane, 3>;

struct Shape {
  uint32_t width, height;
};

// sRGB primaries, D65 (IEC 61966-2-1).
constexpr double xyz_from_rgb[3][3] = {{0.4124564, 0.3575761, 0.1804375},
                                       {0.2126729, 0.7151522, 0.0721750},
                                       {0.0193339, 0.1191920, 0.9503041}};
constexpr double rgb_from_xyz[3][3] = {{3.2404542, -1.5371385, -0.4985314},
                                       {-0.9692660, 1.8760108, 0.0415560},
                                       {0.0556434, -0.2040259, 1.0572252}};
// of (1, 1, 1): sums of the rows of xyz_from_rgb
constexpr Color white = {0.9504700, 1.0000001, 1.0888300};

Color times(const double (&matrix)[3][3], const Color& v) {
  Color out{};
  for (size_t r = 0; r < 3; ++r)
    out[r] = matrix[r][0] * v[0] + matrix[r][1] * v[1] + matrix[r][2] * v[2];
  return out;
}

// Converts to the linear opponent space in which contrast sensitivity is measured (2020, section
// 4.1).
Color ycxcz_from_rgb(const Color& rgb) {
  const Color xyz = times(xyz_from_rgb, rgb);
  const double x = xyz[0] / white[0], y = xyz[1] / white[1], z = xyz[2] / white[2];
  return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}
Color rgb_from_ycxcz(const Color& c) {
  const double y = (c[0] + 16) / 116, x = c[1] / 500 + y, z = y - c[2] / 200;
  return times(rgb_from_xyz, {x * white[0], y * white[1], z * white[2]});
}

// Converts to CIE 1976 L*a*b* with the Hunt effect, by which colours of dark objects look paler
// (2020, section 4.1.2).
Color hunt_lab_from_rgb(const Color& rgb) {
  constexpr double delta = 6.0 / 29;
  const auto f = [](double t) {
    return t > delta * delta * delta ? std::cbrt(t) : t / (3 * delta * delta) + 4.0 / 29;
  };
  const Color xyz = times(xyz_from_rgb, rgb);
  const double x = f(xyz[0] / white[0]), y = f(xyz[1] / white[1]), z = f(xyz[2] / white[2]);
  const double lightness = 116 * y - 16;
  return {lightness, 0.01 * lightness * 500 * (x - y), 0.01 * lightness * 200 * (y - z)};
}

// Distance for large colour differences (Abasi, Amani Tehran and Fairchild 2020).
double hyab(const Color& a, const Color& b) {
  return std::abs(a[0] - b[0]) + std::hypot(a[1] - b[1], a[2] - b[2]);
}

// Weights of offsets -radius..radius.
struct Kernel {
  int radius = 0;
  std::vector<double> weights;
};

template <class Weight> Kernel make_kernel(int radius, Weight weight) {
  Kernel kernel{radius, {}};
  for (int i = -radius; i <= radius; ++i)
    kernel.weights.push_back(weight(double(i)));
  return kernel;
}

double sum_of(const Kernel& kernel) {
  double sum = 0;
  for (const double weight : kernel.weights)
    sum += weight;
  return sum;
}

// Scales positive weights to sum 1 and negative ones to sum -1. Constant input then gives 0, and a
// unit step gives 1.
void balance(Kernel& kernel) {
  double above = 0, below = 0;
  for (const double weight : kernel.weights)
    (weight > 0 ? above : below) += std::abs(weight);
  for (double& weight : kernel.weights)
    weight /= weight > 0 ? above : below;
}

// Filters along rows, or along columns if `columns`. Border pixels are repeated outside.
Plane filtered(const Plane& plane, Shape shape, const Kernel& kernel, bool columns) {
  Plane out(plane.size());
  const int length = static_cast<int>(columns ? shape.height : shape.width);
  const size_t step = columns ? shape.width : 1, lines = columns ? shape.width : shape.height,
               stride = columns ? 1 : shape.width;
  for (size_t line = 0; line < lines; ++line)
    for (int i = 0; i < length; ++i) {
      double sum = 0;
      for (int k = -kernel.radius; k <= kernel.radius; ++k)
        sum += kernel.weights[static_cast<size_t>(k + kernel.radius)] *
               plane[line * stride + static_cast<size_t>(std::clamp(i + k, 0, length - 1)) * step];
      out[line * stride + static_cast<size_t>(i) * step] = sum;
    }
  return out;
}

Plane filtered(const Plane& plane, Shape shape, const Kernel& across, const Kernel& down) {
  return filtered(filtered(plane, shape, across, false), shape, down, true);
}

// Contrast sensitivity of a channel as a sum of two Gaussians of frequency (2020, table 1). In
// space each is a sqrt(pi / b) exp(-pi^2 x^2 / b), x in degrees.
struct Sensitivity {
  double a1, b1, a2, b2;
};
constexpr std::array<Sensitivity, 3> sensitivities{
    {{1, 0.0047, 0, 1e-5}, {1, 0.0053, 0, 1e-5}, {34.1, 0.04, 13.5, 0.025}}};
constexpr double widest = 0.04; // the largest b of the table

Plane contrast_filtered(const Plane& plane, Shape shape, const Sensitivity& channel,
                        double pixels_per_degree) {
  const double pi = std::numbers::pi;
  const int radius =
      static_cast<int>(std::ceil(3 * std::sqrt(widest / (2 * pi * pi)) * pixels_per_degree));
  Plane out(plane.size());
  double total = 0;
  for (const auto& [a, b] :
       {std::pair{channel.a1, channel.b1}, std::pair{channel.a2, channel.b2}}) {
    if (!(a > 0)) continue;
    const Kernel kernel = make_kernel(radius, [&, width = b](double i) {
      const double x = i / pixels_per_degree;
      return std::exp(-pi * pi * x * x / width);
    });
    const double scale = a * std::sqrt(pi / b), sum = sum_of(kernel);
    total += scale * sum * sum;
    const Plane part = filtered(plane, shape, kernel, kernel);
    for (size_t i = 0; i < out.size(); ++i)
      out[i] += scale * part[i];
  }
  for (double& value : out)
    value /= total;
  return out;
}

// Returns colour differences in 0..1 after removing detail that the eye does not resolve.
Plane color_difference(const Planes& a, const Planes& b, Shape shape, double pixels_per_degree) {
  constexpr double exponent = 0.7, knee = 0.4, knee_value = 0.95; // q_c, p_c, p_t of the 2020 paper
  const double largest =
      std::pow(hyab(hunt_lab_from_rgb({0, 1, 0}), hunt_lab_from_rgb({0, 0, 1})), exponent);
  Planes seen_a, seen_b;
  for (size_t c = 0; c < 3; ++c) {
    seen_a[c] = contrast_filtered(a[c], shape, sensitivities[c], pixels_per_degree);
    seen_b[c] = contrast_filtered(b[c], shape, sensitivities[c], pixels_per_degree);
  }
  const auto lab = [](const Planes& planes, size_t i) {
    Color rgb = rgb_from_ycxcz({planes[0][i], planes[1][i], planes[2][i]});
    for (double& value : rgb)
      value = std::clamp(value, 0.0, 1.0);
    return hunt_lab_from_rgb(rgb);
  };
  Plane out(a[0].size());
  for (size_t i = 0; i < out.size(); ++i) {
    const double error = std::pow(hyab(lab(seen_a, i), lab(seen_b, i)), exponent);
    out[i] =
        error < knee * largest
            ? error * knee_value / (knee * largest)
            : knee_value + (error - knee * largest) / (largest - knee * largest) * (1 - knee_value);
  }
  return out;
}

// Returns differences of edges and points between the two lightness planes, 0..1 (2020, section
// 4.2).
Plane feature_difference(const Plane& a, const Plane& b, Shape shape, double pixels_per_degree) {
  constexpr double width_degrees = 0.082, exponent = 0.5; // w, q_f of the 2020 paper
  const double sigma = 0.5 * width_degrees * pixels_per_degree;
  const int radius = static_cast<int>(std::ceil(3 * sigma));
  const auto gauss = [&](double i) { return std::exp(-i * i / (2 * sigma * sigma)); };
  Kernel smooth = make_kernel(radius, gauss);
  const double sum = sum_of(smooth);
  for (double& weight : smooth.weights)
    weight /= sum;
  Kernel edge = make_kernel(radius, [&](double i) { return -i * gauss(i); });
  Kernel point =
      make_kernel(radius, [&](double i) { return (i * i / (sigma * sigma) - 1) * gauss(i); });
  balance(edge);
  balance(point);
  const auto strength = [&](const Plane& plane, const Kernel& kernel) {
    const Plane x = filtered(plane, shape, kernel, smooth),
                y = filtered(plane, shape, smooth, kernel);
    Plane out(plane.size());
    for (size_t i = 0; i < out.size(); ++i)
      out[i] = std::hypot(x[i], y[i]);
    return out;
  };
  const Plane edges_a = strength(a, edge), edges_b = strength(b, edge);
  const Plane points_a = strength(a, point), points_b = strength(b, point);
  Plane out(a.size());
  for (size_t i = 0; i < out.size(); ++i) {
    const double maximum =
        std::max(std::abs(edges_a[i] - edges_b[i]), std::abs(points_a[i] - points_b[i]));
    out[i] = std::pow(maximum / std::numbers::sqrt2, exponent);
  }
  return out;
}

std::vector<float> low_range(const std::vector<Color>& a, const std::vector<Color>& b, Shape shape,
                             double pixels_per_degree) {
  Planes opponent_a, opponent_b;
  for (size_t c = 0; c < 3; ++c) {
    opponent_a[c].resize(a.size());
    opponent_b[c].resize(b.size());
  }
  Plane lightness_a(a.size()), lightness_b(b.size());
  for (size_t i = 0; i < a.size(); ++i) {
    const Color one = ycxcz_from_rgb(a[i]), other = ycxcz_from_rgb(b[i]);
    for (size_t c = 0; c < 3; ++c) {
      opponent_a[c][i] = one[c];
      opponent_b[c][i] = other[c];
    }
    lightness_a[i] = (one[0] + 16) / 116;
    lightness_b[i] = (other[0] + 16) / 116;
  }
  const Plane colors = color_difference(opponent_a, opponent_b, shape, pixels_per_degree);
  const Plane features = feature_difference(lightness_a, lightness_b, shape, pixels_per_degree);
  std::vector<float> out(a.size());
  for (size_t i = 0; i < out.size(); ++i)
    out[i] = static_cast<float>(std::pow(colors[i], 1 - features[i]));
  return out;
}

// Filmic tone curve of Narkowicz 2016 as FLIP uses it (2021), with its factor of 0.6 on the input
// folded in: (k0 x^2 + k1 x) / (k3 x^2 + k4 x + k5).
constexpr double k0 = 0.6 * 0.6 * 2.51, k1 = 0.6 * 0.03, k3 = 0.6 * 0.6 * 2.43, k4 = 0.6 * 0.59,
                 k5 = 0.14;

double tone(double x) {
  return std::clamp((k0 * x * x + k1 * x) / (k3 * x * x + k4 * x + k5), 0.0, 1.0);
}

// Returns the exposures in stops that map the maximum and the median luminance of the reference to
// 0.85 (2021, section 4.1).
std::pair<double, double> exposure_range(const std::vector<Color>& reference) {
  constexpr double target = 0.85;
  const double a = k0 - target * k3, b = k1 - target * k4, c = -target * k5;
  const double x = (-b + std::sqrt(b * b - 4 * a * c)) / (2 * a);
  std::vector<double> luminance;
  for (const Color& color : reference)
    if (const double y = luminance_of(color.data()); y > 0)
      luminance.push_back(y); // black stays black at any exposure
  if (luminance.empty()) return {0, 0};
  const double maximum = *std::max_element(luminance.begin(), luminance.end());
  const auto middle = luminance.begin() + static_cast<std::ptrdiff_t>(luminance.size() / 2);
  std::nth_element(luminance.begin(), middle, luminance.end());
  return {std::log2(x / maximum), std::log2(x / *middle)};
}

std::vector<Color> colors_of(const Image& image, double maximum) {
  std::vector<Color> colors(size_t{image.width} * image.height);
  for (size_t i = 0; i < colors.size(); ++i)
    for (size_t c = 0; c < 3; ++c) {
      const float value = image.values[i * image.channels + (image.channels == 3 ? c : 0)];
      colors[i][c] =
          std::isfinite(value) ? std::clamp(static_cast<double>(value), 0.0, maximum) : 0.0;
    }
  return colors;
}

std::vector<Color> exposed(const std::vector<Color>& colors, double stops) {
  std::vector<Color> out(colors.size());
  const double factor = std::exp2(stops);
  for (size_t i = 0; i < out.size(); ++i)
    for (size_t c = 0; c < 3; ++c)
      out[i][c] = tone(colors[i][c] * factor);
  return out;
}

} // namespace

std::vector<float> flip(const Image& reference, const Image& test, bool high_range,
                        double pixels_per_degree) {
  const Shape shape{reference.width, reference.height};
  constexpr double largest_float = 3.4e38;
  const double maximum = high_range ? largest_float : 1.0;
  const std::vector<Color> a = colors_of(reference, maximum), b = colors_of(test, maximum);
  if (!high_range) return low_range(a, b, shape, pixels_per_degree);
  const auto [start, stop] = exposure_range(a);
  const auto count = std::max(2, static_cast<int>(std::ceil(stop - start)));
  std::vector<float> worst(a.size());
  for (int i = 0; i < count; ++i) {
    const double stops = start + (stop - start) * i / (count - 1);
    const std::vector<float> one =
        low_range(exposed(a, stops), exposed(b, stops), shape, pixels_per_degree);
    for (size_t k = 0; k < worst.size(); ++k)
      worst[k] = std::max(worst[k], one[k]);
  }
  return worst;
}

} // namespace dermis::tools
