// Surfaces of the family in front of others: dither, hair, strands, thin parts.

#include "integration/tools/command/bench/family/surface.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dermis::tools {
namespace {

constexpr double band_width = 16; // pixels

double turned(Place p, double angle) {
  return p.x * std::cos(angle) + p.y * std::sin(angle);
}

// Two parallel planes whose bands of light are opposite.
FamilySurface two_planes(double distance, std::function<bool(PixelIndex)> in_front) {
  return {{{[](Place) { return 0.0; }, {}, [](Place p) { return bands(p.x, band_width); }},
           {[=](Place) { return distance; },
            {},
            [](Place p) { return bands(p.x + band_width, band_width); }}},
          [in_front = std::move(in_front)](PixelIndex at, Place) { return in_front(at) ? 1 : 0; }};
}

} // namespace

double bands(double x, double width) {
  return static_cast<int64_t>(std::floor((x + 0.5) / width)) % 2 == 0 ? 0.15 : 1.0;
}

FamilySurface make_screen_door(const FamilyValues& v) {
  return two_planes(v[0], [](PixelIndex at) { return at.x % 2 != 0 && at.y % 2 != 0; });
}

FamilySurface make_checker_dither(const FamilyValues& v) {
  return two_planes(v[0], [](PixelIndex at) { return (at.x + at.y) % 2 != 0; });
}

FamilySurface make_noise_dither(const FamilyValues& v) {
  return two_planes(v[0], [v](PixelIndex at) { return v.random(at.x + 3, at.y + 9) < v[1]; });
}

FamilySurface make_hair(const FamilyValues& v) {
  const auto width = static_cast<uint32_t>(v[0]), spacing = static_cast<uint32_t>(v[1]);
  return {{{[](Place) { return 0.0; }}, {[=](Place) { return v[2]; }, [=](Place) { return v[3]; }}},
          [=](PixelIndex at, Place) { return at.x % spacing < width ? 1 : 0; }};
}

FamilySurface make_strands(const FamilyValues& v) {
  FamilySurface surface{{{[](Place) { return 0.0; }}}};
  struct Strand {
    double angle, offset;
  };
  std::vector<Strand> strands;
  const double reach = std::hypot(v.size.x, v.size.y);
  for (uint32_t i = 0; i < static_cast<uint32_t>(v[1]); ++i) {
    strands.push_back({std::numbers::pi * v.random(i, 1), reach * (1.4 * v.random(i, 2) - 0.5)});
    const double rise = v[2] * (0.1 + 0.9 * v.random(i, 3)), gain = 0.1 + 0.9 * v.random(i, 4);
    surface.layers.push_back({[=](Place) { return rise; }, [=](Place) { return gain; }});
  }
  surface.visible = [=, layers = surface.layers](PixelIndex, Place p) {
    int nearest = 0;
    for (size_t i = 0; i < strands.size(); ++i)
      if (std::abs(turned(p, strands[i].angle) - strands[i].offset) < 0.5 * v[0] &&
          layers[i + 1].rise(p) > layers[static_cast<size_t>(nearest)].rise(p))
        nearest = static_cast<int>(i) + 1;
    return nearest;
  };
  return surface;
}

FamilySurface make_holes(const FamilyValues& v) {
  const int below = v[2] > 0 ? 1 : FamilySurface::background;
  return {{{[](Place) { return 0.0; }}, {[=](Place) { return -v[2]; }, [](Place) { return 0.3; }}},
          [=](PixelIndex, Place p) {
            const double x = p.x - v[1] * std::round(p.x / v[1]),
                         y = p.y - v[1] * std::round(p.y / v[1]);
            return std::hypot(x, y) < v[0] ? below : 0;
          }};
}

FamilySurface make_bars(const FamilyValues& v) {
  const double spacing = v[0] + v[1], radius = 0.5 * v[0];
  const auto across = [=](Place p) { return p.x - spacing * std::round(p.x / spacing); };
  return {{{[=](Place p) {
            return std::sqrt(std::max(0.0, radius * radius - across(p) * across(p)));
          }}},
          [=](PixelIndex, Place p) {
            return std::abs(across(p)) < radius ? 0 : FamilySurface::background;
          }};
}

FamilySurface make_ridges(const FamilyValues& v) {
  return {{{[=](Place p) {
    const double u = std::abs(p.x - v[1] * std::round(p.x / v[1]));
    return v[2] * std::max(0.0, 1 - 2 * u / v[0]);
  }}}};
}

} // namespace dermis::tools
