// Properties of scattering on planes that face the viewer, on tilted planes and across steps, for
// any technique.

#include "integration/tools/command/bench/truth/properties.hpp"

#include "integration/tools/command/bench/subject.hpp"
#include "integration/tools/references/analytic.hpp"
#include "passes/common/profiles/burley_profile.hpp"
#include "passes/common/reference/planar.hpp"
#include "passes/common/reference/surface.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace dermis::tools {
namespace {

constexpr double middle_x = property_width / 2, middle_y = property_height / 2; // pixels
constexpr double d = 4;                  // pixels, except where stated otherwise
constexpr uint32_t samples_per_side = 8; // per side of a pixel, for light with edges

using Light = std::function<double(double x, double y)>; // pixels from the middle pixel's centre

void paint(CapturedFrame& frame, const Light& light, uint32_t samples = samples_per_side) {
  for (uint32_t y = 0; y < property_height; ++y)
    for (uint32_t x = 0; x < property_width; ++x) {
      double sum = 0;
      for (uint32_t j = 0; j < samples; ++j)
        for (uint32_t i = 0; i < samples; ++i)
          sum += light(x + (i + 0.5) / samples - 0.5 - middle_x,
                       y + (j + 0.5) / samples - 0.5 - middle_y);
      for (uint32_t c = 0; c < 3; ++c)
        frame.lighting.at(x, y, c) = static_cast<float>(sum / (samples * samples));
    }
}

CapturedFrame plane(double d_px) {
  const std::vector<CaptureProfile> profiles = property_profiles();
  return plane_frame(property_width, property_height, d_px, profiles);
}

struct Probe {
  const PropertySubject& subject;
  std::vector<PropertyRow> rows = {};
  std::vector<float> light = {}; // of the last frame
  std::optional<demo::Error> error = {};

  bool scatter(const CapturedFrame& frame) {
    if (error) return false;
    auto result = subject.scatter(frame);
    if (result)
      light = result.take();
    else
      error = result.error();
    return !error;
  }
  // Returns the first channel; coordinates are relative to the middle pixel.
  double at(int x, int y) const {
    return double(light[3 * (static_cast<size_t>(y + int(middle_y)) * property_width +
                             static_cast<size_t>(x + int(middle_x)))]);
  }
  void add(std::string_view property, std::string what, double expected, double measured) {
    std::optional<double> tolerance;
    for (const auto& [name, value] : subject.tolerances)
      if (name == property) tolerance = value;
    rows.push_back({what.empty() ? std::string(property) : fmt::format("{}: {}", property, what),
                    subject.name, expected, measured, tolerance});
  }
};

void white_furnace(Probe& probe) {
  for (const double d_px : {0.3, 1.0, 4.0, 16.0}) {
    if (!probe.scatter(plane(d_px))) return;
    double worst = 0;
    for (const float value : probe.light)
      worst = std::max(worst, std::abs(double(value) - 1));
    probe.add("white_furnace", fmt::format("largest deviation from 1, d = {} px", d_px), 0, worst);
  }
}

// Light is constant per pixel and the middle column is half lit: the mean of two edges, each of
// half the height.
double edge_of_columns(double x, double d_px, double stretch = 1) {
  return 0.5 * (subsurface::burley_edge((x - 0.5) * stretch, d_px) +
                subsurface::burley_edge((x + 0.5) * stretch, d_px));
}

void edge(Probe& probe) {
  CapturedFrame frame = plane(d);
  paint(frame, [](double x, double) { return x > 0 ? 1.0 : 0.0; });
  if (!probe.scatter(frame)) return;
  for (const int x : {-16, -4, -1, 0, 1, 2, 4, 8, 16}) {
    double mean = 0;
    for (int y = -8; y < 8; ++y)
      mean += probe.at(x, y) / 16;
    probe.add("edge", fmt::format("mean of a column at {} d", x / d), edge_of_columns(x, d), mean);
  }
}

void slanted_edge(Probe& probe) {
  const double half = std::sqrt(0.5);
  CapturedFrame frame = plane(d);
  paint(frame, [&](double x, double y) { return half * (x + y) > 0 ? 1.0 : 0.0; });
  if (!probe.scatter(frame)) return;
  double squares = 0, count = 0;
  for (int y = -8; y <= 8; ++y)
    for (int x = -64; x <= 64; ++x) {
      const double error = probe.at(x, y) - subsurface::burley_edge(half * (x + y), d);
      squares += error * error;
      ++count;
    }
  // Averaging over pixels changes an edge's response by about a third of a pixel's variance times
  // its curvature.
  probe.add("slanted_edge", "RMSE around an edge at 45 degrees", 0, std::sqrt(squares / count));
}

// Least-squares fit of a + b cos over the middle. b is half the remaining contrast.
double contrast(const Probe& probe, double kx, double ky) {
  double n = 0, sc = 0, scc = 0, sy = 0, syc = 0;
  for (int y = -16; y < 16; ++y)
    for (int x = -160; x < 160; ++x) {
      const double c = std::cos(kx * x + ky * y), value = probe.at(x, y);
      n += 1;
      sc += c;
      scc += c * c;
      sy += value;
      syc += value * c;
    }
  return 2 * (n * syc - sc * sy) / (n * scc - sc * sc);
}

double unnormalised_sinc(double x) {
  return std::abs(x) < 1e-9 ? 1 : std::sin(x) / x;
}

// Returns the remaining contrast of a sinusoid that is sampled at pixel centres and constant per
// pixel. At the centres all its aliases at multiples of the sampling frequency look like the
// sinusoid itself.
double sampled_contrast(double kx, double ky) {
  constexpr int images = 24; // each further image adds less than 1e-6
  constexpr double sampling = 2 * 3.14159265358979323846;
  double sum = 0;
  for (int j = -images; j <= images; ++j)
    for (int i = -images; i <= images; ++i) {
      const double fx = kx + sampling * i, fy = ky + sampling * j;
      sum += subsurface::burley_mtf(std::hypot(fx, fy), d) * unnormalised_sinc(fx / 2) *
             unnormalised_sinc(fy / 2);
    }
  return sum;
}

void sinusoid(Probe& probe) {
  for (const bool diagonal : {false, true})
    for (const double kd : {0.5, 1.0, 2.0, 5.0}) {
      const double k = kd / d, kx = diagonal ? k * std::sqrt(0.5) : k, ky = diagonal ? kx : 0;
      CapturedFrame frame = plane(d);
      paint(
          frame, [&](double x, double y) { return 0.5 + 0.5 * std::cos(kx * x + ky * y); }, 1);
      if (!probe.scatter(frame)) return;
      probe.add(diagonal ? "sinusoid_45" : "sinusoid", fmt::format("contrast, k d = {}", kd),
                sampled_contrast(kx, ky), contrast(probe, kx, ky));
    }
}

void disc(Probe& probe) {
  for (const double rho : {1.0, 2.0, 4.0, 8.0}) {
    CapturedFrame frame = plane(d);
    paint(frame, [&](double x, double y) { return std::hypot(x, y) < rho * d ? 1.0 : 0.0; });
    if (!probe.scatter(frame)) return;
    probe.add("disc", fmt::format("centre, radius {} d", rho),
              subsurface::burley_disc(0, rho * d, d), probe.at(0, 0));
    if (rho == 4.0)
      for (const int x : {8, 16, 24})
        probe.add("disc", fmt::format("{} d from the centre, radius 4 d", x / d),
                  subsurface::burley_disc(x, rho * d, d),
                  0.25 * (probe.at(x, 0) + probe.at(-x, 0) + probe.at(0, x) + probe.at(0, -x)));
  }
}

void gaussian(Probe& probe) {
  for (const double s : {0.5, 2.0}) {
    const double d_px = s < 1 ? 2 * d : d; // averaging over pixels widens the light: sigma^2 + 1/12
    CapturedFrame frame = plane(d_px);
    const double sigma = s * d_px;
    paint(frame,
          [&](double x, double y) { return std::exp(-(x * x + y * y) / (2 * sigma * sigma)); });
    if (!probe.scatter(frame)) return;
    probe.add("gaussian", fmt::format("centre, s = {} d", s),
              subsurface::burley_gaussian_centre(sigma, d_px), probe.at(0, 0));
  }
}

void polynomial(Probe& probe) {
  CapturedFrame frame = plane(2);
  paint(
      frame, [](double x, double) { return 0.5 + x / property_width; }, 1);
  if (!probe.scatter(frame)) return;
  double worst = 0;
  for (int x = -64; x <= 64; ++x)
    worst = std::max(worst, std::abs(probe.at(x, 0) - (0.5 + double(x) / property_width)));
  probe.add("ramp", "largest deviation in the middle", 0, worst);

  const double scale = 1 / (middle_x * middle_x);
  paint(
      frame, [&](double x, double) { return x * x * scale; }, 1);
  if (!probe.scatter(frame)) return;
  probe.add("parabola", "E[x^2] at the vertex, in d^2", 7, probe.at(0, 0) / (4 * scale));
}

// The edge response in distances along the tilted surface.
void tilted_edge(Probe& probe) {
  for (const double degrees : {30.0, 60.0}) {
    const double slope = std::tan(degrees * 3.14159265358979323846 / 180),
                 stretch = std::sqrt(1 + slope * slope);
    CapturedFrame frame = plane(d);
    const double pitch = *frame.description.pixel_pitch_m;
    for (uint32_t y = 0; y < property_height; ++y)
      for (uint32_t x = 0; x < property_width; ++x)
        frame.depth.at(x, y, 0) = static_cast<float>(1 + slope * pitch * (x - middle_x));
    paint(frame, [](double x, double) { return x > 0 ? 1.0 : 0.0; });
    if (!probe.scatter(frame)) return;
    double squares = 0;
    for (int x = -32; x <= 32; ++x) {
      double mean = 0;
      for (int y = -8; y < 8; ++y)
        mean += probe.at(x, y) / 16;
      const double error = mean - edge_of_columns(x, d, stretch);
      squares += error * error;
    }
    probe.add(degrees < 45 ? "tilted_edge_30" : "tilted_edge_60",
              "RMSE of columns, in surface distance", 0, std::sqrt(squares / 65));
  }
}

// Returns the light at a sphere's pole, which sees half of the sphere: chords up to sqrt(2) R, by
// Simpson's rule.
double sphere_pole(const Light& of_cosine, double radius, double d_px) {
  constexpr int steps = 4000; // even
  double light = 0, all = 0;
  for (int i = 0; i <= steps; ++i) {
    const double r = std::sqrt(2.0) * radius * i / steps,
                 cosine = 1 - r * r / (2 * radius * radius);
    const double weight = (i == 0 || i == steps ? 1
                           : i % 2 == 1         ? 4
                                                : 2) *
                          subsurface::burley_pdf(r, d_px) *
                          std::min(1.0, cosine / subsurface::min_patch_cosine);
    light += weight * of_cosine(cosine, 0);
    all += weight;
  }
  return light / all;
}

void sphere(Probe& probe) {
  constexpr double wide = 4 * d, radius = 5 * wide; // pixels
  CapturedFrame frame = plane(wide);
  const double pitch = *frame.description.pixel_pitch_m;
  for (uint32_t y = 0; y < property_height; ++y)
    for (uint32_t x = 0; x < property_width; ++x) {
      const double rho = std::hypot(x - middle_x, y - middle_y);
      frame.profile[size_t{y} * property_width + x] = rho < radius ? 1 : 0;
      frame.depth.at(x, y, 0) = static_cast<float>(
          1 + pitch * (radius - std::sqrt(std::max(0.0, radius * radius - rho * rho))));
    }
  const std::pair<int, Light> harmonics[] = {
      {1, [](double c, double) { return c; }},
      {2, [](double c, double) { return 1.5 * c * c - 0.5; }}};
  for (const auto& [degree, harmonic] : harmonics) {
    const Light light = [&of = harmonic](double c, double) { return 0.5 + 0.5 * of(c, 0); };
    paint(
        frame,
        [&](double x, double y) {
          return light(std::sqrt(std::max(0.0, 1 - (x * x + y * y) / (radius * radius))), 0);
        },
        1);
    if (!probe.scatter(frame)) return;
    probe.add("sphere", fmt::format("pole of a sphere of radius 5 d, harmonic {}", degree),
              sphere_pole(light, radius, wide), probe.at(0, 0));
  }
}

double leak(const Probe& probe) {
  double worst = 0;
  for (uint32_t y = 0; y < property_height; ++y)
    for (uint32_t x = 0; x < property_width; ++x) {
      if (!is_looked_at(x, y)) continue;
      const double expected = x < property_width / 2 ? 1 : 0;
      worst = std::max(
          worst, std::abs(double(probe.light[3 * (size_t{y} * property_width + x)]) - expected));
    }
  return worst;
}

void borders(Probe& probe) {
  CapturedFrame frame = plane(d);
  paint(
      frame, [](double x, double) { return x < -0.5 ? 1.0 : 0.0; }, 1);
  for (uint32_t i = 0; i < frame.profile.size(); ++i)
    if (i % property_width >= property_width / 2) frame.profile[i] = 2;
  if (!probe.scatter(frame)) return;
  probe.add("two_materials", "largest leak", 0, leak(probe));

  std::fill(frame.profile.begin(), frame.profile.end(), uint8_t{1});
  const double pitch = *frame.description.pixel_pitch_m;
  for (uint32_t i = 0; i < frame.profile.size(); ++i)
    if (i % property_width >= property_width / 2)
      frame.depth.values[i] = static_cast<float>(1 + 100 * d * pitch);
  if (!probe.scatter(frame)) return;
  probe.add("depth_step", "largest leak over a step of 100 d", 0, leak(probe));
}

// The same light and d at twice the size: means of 2x2 pixels must equal the pixels at single size.
void scale_invariance(Probe& probe) {
  const auto pattern = [](double x, double y) {
    return 0.5 + 0.5 * std::sin(0.05 * x) * std::cos(0.11 * y) * (x * y > 0 ? 1 : -0.4);
  };
  CapturedFrame small = plane(d), large = plane(2 * d);
  paint(small, [&](double x, double y) { return pattern(x + 0.5, y + 0.5); });
  paint(large, [&](double x, double y) { return pattern((x + 0.5) / 2, (y + 0.5) / 2); });
  if (!probe.scatter(small)) return;
  const std::vector<float> first = probe.light;
  if (!probe.scatter(large)) return;
  const std::vector<float> second = probe.light;
  double squares = 0, count = 0;
  for (int y = -10; y < 10; ++y)
    for (int x = -90; x < 90; ++x) {
      const auto of = [&](const std::vector<float>& image, int px, int py) {
        return double(image[3 * (static_cast<size_t>(py + int(middle_y)) * property_width +
                                 static_cast<size_t>(px + int(middle_x)))]);
      };
      const double mean = 0.25 * (of(second, 2 * x, 2 * y) + of(second, 2 * x + 1, 2 * y) +
                                  of(second, 2 * x, 2 * y + 1) + of(second, 2 * x + 1, 2 * y + 1));
      squares += (mean - of(first, x, y)) * (mean - of(first, x, y));
      ++count;
    }
  probe.add("scale_invariance", "RMS difference of one scene at two sizes", 0,
            std::sqrt(squares / count));
}

struct Property {
  std::string_view name;
  void (*measure)(Probe&);
};
constexpr Property properties[] = {{"white_furnace", white_furnace},
                                   {"edge", edge},
                                   {"slanted_edge", slanted_edge},
                                   {"sinusoid", sinusoid},
                                   {"disc", disc},
                                   {"gaussian", gaussian},
                                   {"ramp", polynomial},
                                   {"tilted_edge", tilted_edge},
                                   {"two_materials", borders},
                                   {"scale_invariance", scale_invariance},
                                   {"sphere", sphere}};

} // namespace

bool is_looked_at(uint32_t x, uint32_t y) {
  constexpr uint32_t band = 8, reach = 40; // pixels from the middle
  return y + band >= property_height / 2 && y < property_height / 2 + band &&
         x + reach >= property_width / 2 && x <= property_width / 2 + reach;
}

std::vector<CaptureProfile> property_profiles() {
  subsurface::Profile other = grey_profile();
  other.name = "other_grey";
  return {{1, grey_profile()}, {2, other}};
}

std::vector<std::string_view> plane_property_names() {
  return {"white_furnace",  "edge",     "slanted_edge",  "sinusoid",   "sinusoid_45",
          "disc",           "gaussian", "ramp",          "parabola",   "tilted_edge_30",
          "tilted_edge_60", "sphere",   "two_materials", "depth_step", "scale_invariance"};
}

demo::Result<std::vector<PropertyRow>> plane_properties(const PropertySubject& subject) {
  Probe probe{subject};
  for (const Property& property : properties)
    property.measure(probe);
  if (probe.error) return *probe.error;
  return probe.rows;
}

} // namespace dermis::tools
