// Scenes generated from functions of position: light, depth, profile.

#include "integration/tools/command/bench/pattern.hpp"
#include "integration/tools/command/bench/subject.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

namespace dermis::tools {
namespace {

constexpr double view_distance = 1.0; // metres, as in plane_frame
using std::numbers::pi;
constexpr uint32_t sub_samples = 4; // per side of a pixel, for light with edges

struct Painter {
  CapturedFrame& frame;
  double height; // pixels
  double d_px, pitch;

  uint32_t columns() const { return frame.description.width; }
  uint32_t rows() const { return frame.description.height; }

  // Sets all channels to the mean of `value` over sub-points of each pixel.
  void light(const std::function<double(Place)>& value) {
    for (uint32_t y = 0; y < rows(); ++y)
      for (uint32_t x = 0; x < columns(); ++x) {
        double sum = 0;
        for (uint32_t j = 0; j < sub_samples; ++j)
          for (uint32_t i = 0; i < sub_samples; ++i)
            sum += value({x + (i + 0.5) / sub_samples - 0.5, y + (j + 0.5) / sub_samples - 0.5});
        for (uint32_t c = 0; c < 3; ++c)
          frame.lighting.at(x, y, c) = static_cast<float>(sum / (sub_samples * sub_samples));
      }
  }

  // Sets the height towards the viewer, pixels above the plane at view_distance. NaN means
  // background.
  void rise(const std::function<double(Place)>& value) {
    for (uint32_t y = 0; y < rows(); ++y)
      for (uint32_t x = 0; x < columns(); ++x) {
        const double above = value({double(x), double(y)});
        const bool there = !std::isnan(above);
        frame.depth.at(x, y, 0) = there ? static_cast<float>(view_distance - above * pitch) : 0.0f;
        frame.profile[size_t{y} * columns() + x] = there ? 1 : 0;
      }
  }
};

void paint_edge(Painter& painter) {
  const double middle = 0.5 * painter.columns();
  painter.light(
      [&](Place p) { return p.x - middle > (p.y - 0.5 * painter.height) / 3 ? 1.0 : 0.1; });
}

void paint_disc(Painter& painter) {
  struct Disc {
    double x, y, radius; // picture heights
  };
  constexpr Disc discs[] = {{0.35, 0.5, 0.25},  {0.80, 0.30, 0.11},  {0.82, 0.74, 0.055},
                            {1.05, 0.5, 0.028}, {1.2, 0.25, 0.014},  {1.22, 0.72, 0.007},
                            {1.42, 0.4, 0.16},  {1.45, 0.82, 0.0035}};
  painter.light([&](Place p) {
    for (const Disc& one : discs)
      if (std::hypot(p.x / painter.height - one.x, p.y / painter.height - one.y) < one.radius)
        return 1.0;
    return 0.0;
  });
}

// Two waves with slopes of up to 50 degrees.
void paint_bumps(Painter& painter) {
  const double wide = 2 * pi / (0.33 * painter.height), fine = 2 * pi / (0.08 * painter.height);
  const double a = 0.85 / wide, b = 0.35 / fine;
  painter.rise([&](Place p) {
    return a * std::sin(wide * p.x) * std::sin(wide * p.y) +
           b * std::sin(fine * p.x + 1) * std::sin(fine * p.y);
  });
  painter.light([&](Place p) {
    const double sx = a * wide * std::cos(wide * p.x) * std::sin(wide * p.y) +
                      b * fine * std::cos(fine * p.x + 1) * std::sin(fine * p.y);
    const double sy = a * wide * std::sin(wide * p.x) * std::cos(wide * p.y) +
                      b * fine * std::sin(fine * p.x + 1) * std::cos(fine * p.y);
    return shade(sx, sy);
  });
}

void paint_sphere(Painter& painter) {
  const double radius = 0.42 * painter.height, cx = 0.5 * painter.columns() - 0.5,
               cy = 0.5 * painter.height - 0.5;
  painter.rise([&](Place p) {
    const double z2 = radius * radius - (p.x - cx) * (p.x - cx) - (p.y - cy) * (p.y - cy);
    return z2 > 0 ? std::sqrt(z2) : std::nan("");
  });
  painter.light([&](Place p) {
    const double x = p.x - cx, y = p.y - cy, z2 = radius * radius - x * x - y * y;
    if (!(z2 > 1)) return 0.0;
    return shade(-x / std::sqrt(z2), -y / std::sqrt(z2));
  });
}

void paint_texture(Painter& painter) {
  painter.light([](Place p) { return texture(p); });
}

void paint_depth_step(Painter& painter) {
  constexpr double steps_in_d[] = {0, 0.5, 2, 5, 20};
  const double band = painter.columns() / double(std::size(steps_in_d));
  const auto band_of = [&](double x) {
    return std::min<size_t>(static_cast<size_t>(std::max(0.0, x + 0.5) / band),
                            std::size(steps_in_d) - 1);
  };
  painter.rise([&](Place p) {
    double above = 0;
    for (size_t i = 0; i <= band_of(p.x); ++i)
      above -= steps_in_d[i] * painter.d_px;
    return above;
  });
  painter.light(
      [&](Place p) { return (band_of(p.x) % 2 == 0 ? 1.0 : 0.25) * (0.6 + 0.4 * texture(p)); });
}

// Framing "mixed": one material under several ids, in cells as wide as a kernel, to measure the
// cost of distinguishing profiles.
constexpr uint32_t mixed_profiles = 4;
constexpr uint32_t mixed_cell = 64; // pixels

struct Generator {
  std::string_view scene;
  void (*paint)(Painter&);
};
constexpr Generator generators[] = {{"edge", paint_edge},
                                    {"disc", paint_disc},
                                    {"bumps", paint_bumps},
                                    {"sphere", paint_sphere},
                                    {"depth_step", paint_depth_step},
                                    {"texture_plane", paint_texture}};

} // namespace

bool is_generated(std::string_view scene) {
  return std::any_of(std::begin(generators), std::end(generators),
                     [&](const Generator& one) { return one.scene == scene; });
}

CapturedFrame generate_scene(const std::string& scene, const std::string& framing, uint32_t width,
                             uint32_t height, double d_px, const subsurface::Profile& skin) {
  std::vector<CaptureProfile> profiles{{1, scene == "texture_plane" ? grey_profile() : skin}};
  if (framing == "mixed")
    while (profiles.size() < mixed_profiles) {
      CaptureProfile another = profiles.front();
      another.id = static_cast<uint32_t>(profiles.size() + 1);
      another.profile.name += fmt::format(" {}", another.id);
      profiles.push_back(std::move(another));
    }
  CapturedFrame frame = plane_frame(width, height, d_px, profiles);
  Painter painter{frame, double(height), d_px, *frame.description.pixel_pitch_m};
  for (const Generator& one : generators)
    if (one.scene == scene) one.paint(painter);
  if (framing == "mixed")
    for (size_t i = 0; i < frame.profile.size(); ++i)
      frame.profile[i] = static_cast<uint8_t>(
          1 + (i % width / mixed_cell + i / width / mixed_cell * 2) % mixed_profiles);
  if (framing == "varying") {
    frame.scatter_scale = Image::sized(width, height, 1);
    for (size_t i = 0; i < frame.scatter_scale.values.size(); ++i)
      frame.scatter_scale.values[i] =
          std::exp2(-3.0f * static_cast<float>(i % width) / static_cast<float>(width - 1));
  }
  return frame;
}

} // namespace dermis::tools
