// Surfaces of the family with folds and steps.

#include "integration/tools/command/bench/family/surface.hpp"

#include <cmath>
#include <numbers>

namespace dermis::tools {
namespace {

using std::numbers::pi;

double along(Place p, double degrees) {
  return p.x * std::cos(degrees * radians_per_degree) +
         p.y * std::sin(degrees * radians_per_degree);
}

// Returns the fraction of a period at x, in [0, 1).
double phase(double x, double period) {
  return x / period - std::floor(x / period);
}

} // namespace

FamilySurface make_zigzag(const FamilyValues& v) {
  const double slope = std::tan(v[0] * radians_per_degree);
  return {{{[=](Place p) {
    return slope * v[1] * (0.5 - std::abs(phase(along(p, v[2]), v[1]) - 0.5));
  }}}};
}

FamilySurface make_grooves(const FamilyValues& v) {
  const auto inside = [=](Place p) { return phase(p.x + 0.5, v[2]) * v[2] < v[0]; };
  return {{{[=](Place p) { return inside(p) ? -v[1] : 0.0; },
            [=](Place p) { return inside(p) ? v[3] : 1.0; }}}};
}

FamilySurface make_wave(const FamilyValues& v) {
  const double wave = 2 * pi / v[0], a = std::tan(v[1] * radians_per_degree) / wave;
  return {{{[=](Place p) { return a * std::sin(wave * along(p, v[2])); }}}};
}

FamilySurface make_step(const FamilyValues& v) {
  const auto above = [=](Place p) { return p.x + 0.25 * p.y < 0.5 * v.size.x; };
  return {{{[=](Place p) { return above(p) ? v[0] : 0.0; },
            [=](Place p) { return above(p) ? 1.0 : v[1]; }}}};
}

FamilySurface make_stairs(const FamilyValues& v) {
  const auto tread = [=](Place p) { return std::floor((p.x + 0.5) / v[0]); };
  return {{{[=](Place p) { return v[1] * tread(p); },
            [=](Place p) { return static_cast<int>(tread(p)) % 2 != 0 ? v[2] : 1.0; }}}};
}

FamilySurface make_plates(const FamilyValues& v) {
  return {{{[=](Place p) {
    return v[1] * v.random(static_cast<uint32_t>((p.x + 0.5) / v[0] + 64),
                           static_cast<uint32_t>((p.y + 0.5) / v[0] + 64));
  }}}};
}

FamilySurface make_scales(const FamilyValues& v) {
  const double slope = std::tan(v[1] * radians_per_degree);
  const auto shifted = [=](Place p) { // rows of scales are shifted by half a scale
    const double row = std::floor((p.y + 0.5) / v[0]);
    return p.x + 0.5 + 0.5 * v[0] * std::fmod(std::abs(row), 2.0);
  };
  return {{{[=](Place p) { return slope * v[0] * phase(shifted(p), v[0]); }}}};
}

} // namespace dermis::tools
