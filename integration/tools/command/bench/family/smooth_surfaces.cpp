// Surfaces of the family without folds and steps.

#include "integration/tools/command/bench/family/surface.hpp"

#include <cmath>
#include <numbers>

namespace dermis::tools {
namespace {

using std::numbers::pi;

// Returns a value in [0, 1) that is interpolated between random values on a grid.
double smooth_noise(const FamilyValues& v, Place p, double cell, uint32_t octave) {
  const double x = p.x / cell + 64, y = p.y / cell + 64;
  const double fx = std::floor(x), fy = std::floor(y);
  const auto weight = [](double t) { return t * t * (3 - 2 * t); };
  const double u = weight(x - fx), w = weight(y - fy);
  const auto at = [&](double i, double j) {
    return v.random(static_cast<uint32_t>(i) + 1009 * octave, static_cast<uint32_t>(j));
  };
  return (1 - w) * ((1 - u) * at(fx, fy) + u * at(fx + 1, fy)) +
         w * ((1 - u) * at(fx, fy + 1) + u * at(fx + 1, fy + 1));
}

} // namespace

FamilySurface make_plane(const FamilyValues&) {
  return {{{[](Place) { return 0.0; }}}};
}

FamilySurface make_bands(const FamilyValues& v) {
  return {{{[](Place) { return 0.0; }, {}, [v](Place p) { return bands(p.x, v[0]); }}}};
}

FamilySurface make_tilt(const FamilyValues& v) {
  const double slope = std::tan(v[0] * radians_per_degree),
               sx = slope * std::cos(v[1] * radians_per_degree),
               sy = slope * std::sin(v[1] * radians_per_degree);
  return {{{[=](Place p) { return sx * (p.x - 0.5 * v.size.x) + sy * (p.y - 0.5 * v.size.y); }}}};
}

FamilySurface make_bumps(const FamilyValues& v) {
  const double wide = 2 * pi / v[0], fine = 4.125 * wide,
               slope = std::tan(v[1] * radians_per_degree);
  const double a = 0.7 * slope / wide, b = 0.3 * slope / fine, shift = 2 * pi * v.random(1);
  return {{{[=](Place p) {
    return a * std::sin(wide * p.x + shift) * std::sin(wide * p.y) +
           b * std::sin(fine * p.x + 1) * std::sin(fine * p.y);
  }}}};
}

FamilySurface make_egg_crate(const FamilyValues& v) {
  const double wave = 2 * pi / v[0], a = std::tan(v[1] * radians_per_degree) / wave;
  return {{{[=](Place p) { return a * std::sin(wave * p.x) * std::sin(wave * p.y); }}}};
}

FamilySurface make_sphere(const FamilyValues& v) {
  const double radius = v[0] * v.size.y;
  const Place middle{0.5 * (v.size.x - 1) + 4 * (v.random(1) - 0.5),
                     0.5 * (v.size.y - 1) + 4 * (v.random(2) - 0.5)};
  const auto squared = [=](Place p) {
    return radius * radius - (p.x - middle.x) * (p.x - middle.x) -
           (p.y - middle.y) * (p.y - middle.y);
  };
  return {{{[=](Place p) { return std::sqrt(std::max(0.0, squared(p))); }}},
          [=](PixelIndex, Place p) { return squared(p) > 0 ? 0 : FamilySurface::background; }};
}

FamilySurface make_cylinders(const FamilyValues& v) {
  const double radius = v[0], spacing = 2 * v[0] + v[1];
  return {{{[=](Place p) {
    const double u = p.x - spacing * std::round(p.x / spacing);
    return std::sqrt(std::max(0.0, radius * radius - u * u));
  }}}};
}

FamilySurface make_noise(const FamilyValues& v) {
  const auto normal = [v](uint32_t x, uint32_t y) { // Box and Muller 1958
    return std::sqrt(-2 * std::log(1 - v.random(x + 7, y))) * std::cos(2 * pi * v.random(x, y + 7));
  };
  return {{{[=](Place p) {
    return v[0] * normal(static_cast<uint32_t>(p.x + 64.5), static_cast<uint32_t>(p.y + 64.5));
  }}}};
}

FamilySurface make_fractal(const FamilyValues& v) {
  return {{{[v](Place p) {
    double rise = 0, height = v[0], cell = v[1];
    for (uint32_t octave = 0; octave < 5; ++octave, height *= 0.5, cell *= 0.5)
      rise += height * (smooth_noise(v, p, cell, octave) - 0.5);
    return rise;
  }}}};
}

} // namespace dermis::tools
