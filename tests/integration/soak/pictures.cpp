#include "tests/integration/soak/pictures.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace dermis::abi_test {
namespace {

constexpr size_t pixels = size_t{soak_side} * soak_side;
constexpr float plane_m = 0.5f, half_max = 65504.0f;

} // namespace

double unit(SplitMix64& random) {
  constexpr uint32_t steps = 1u << 20;
  return static_cast<double>(random.below(steps)) / steps;
}

Surface draw_surface(SplitMix64& random) {
  Surface surface;
  surface.depth.assign(pixels, plane_m);
  surface.material.assign(pixels, 1.0f);
  surface.velocity.assign(2 * pixels, 0.0f);
  const uint32_t shape = static_cast<uint32_t>(random.below(9)),
                 at = static_cast<uint32_t>(random.below(soak_side));
  const auto pan = static_cast<float>(unit(random) < 0.5 ? 0.0 : 4.0 * unit(random) - 2.0);
  for (uint32_t y = 0; y < soak_side; ++y)
    for (uint32_t x = 0; x < soak_side; ++x) {
      const size_t i = size_t{y} * soak_side + x;
      const double dx = (x + 0.5) / soak_side - 0.5, dy = (y + 0.5) / soak_side - 0.5;
      const double inside = 0.2 - dx * dx - dy * dy;
      surface.velocity[2 * i] = pan;
      switch (shape) {
      case 0: // One plane.
        break;
      case 1: // A step of 2 cm.
        surface.depth[i] = x < at ? plane_m : plane_m + 0.02f;
        break;
      case 2: // A ball in front of nothing.
        surface.depth[i] =
            inside > 0 ? static_cast<float>(plane_m - 0.02 * std::sqrt(inside)) : 0.0f;
        surface.material[i] = inside > 0 ? 1.0f : 0.0f;
        break;
      case 3: // Hairs.
        surface.material[i] = x % 7 == 3 ? 1.0f : 0.0f;
        break;
      case 4: // Isolated pixels.
        surface.material[i] = x % 5 == 2 && y % 5 == 2 ? 2.0f : 0.0f;
        break;
      case 5: // Two profiles in cells.
        surface.material[i] = (x / 6 + y / 6) % 2 == 0 ? 1.0f : 2.0f;
        break;
      case 6: // Nothing.
        surface.material[i] = 0.0f;
        break;
      case 7: // A plane at a grazing angle.
        surface.depth[i] = static_cast<float>(plane_m + 0.05 * dx);
        break;
      default: // Invalid depth on one side.
        surface.depth[i] =
            x < at ? plane_m : (at % 2 == 0 ? -1.0f : std::numeric_limits<float>::infinity());
        break;
      }
    }
  return surface;
}

Light draw_light(SplitMix64& random, bool damaged) {
  constexpr std::array levels = {1e-4, 0.1, 1.0, 1.0, 1.0, 8.0, 6e4};
  Light light;
  light.texels.assign(4 * pixels, 0.0f);
  const double level = levels[random.below(levels.size())];
  const uint32_t pattern = static_cast<uint32_t>(random.below(6)),
                 at = static_cast<uint32_t>(random.below(soak_side));
  for (uint32_t y = 0; y < soak_side; ++y)
    for (uint32_t x = 0; x < soak_side; ++x) {
      double fraction = 1.0; // Even light.
      if (pattern == 1) fraction = x < at ? 1.0 : 0.0;
      if (pattern == 2) fraction = (x + y) % 2 == 0 ? 1.0 : 0.25;
      if (pattern == 3) fraction = unit(random);
      if (pattern == 4) fraction = x == at && y == at ? 1.0 : 0.01;
      if (pattern == 5) fraction = 0.5 + 0.4 * std::sin(0.4 * x);
      for (size_t c = 0; c < 3; ++c)
        light.texels[4 * (size_t{y} * soak_side + x) + c] = static_cast<float>(fraction * level);
    }
  light.even = pattern == 0 && !damaged;
  light.brightest = level;
  if (damaged) {
    constexpr std::array bad = {std::numeric_limits<float>::quiet_NaN(),
                                std::numeric_limits<float>::infinity(), -1.0f,
                                -std::numeric_limits<float>::infinity(), 1e-7f};
    for (int i = 0; i < 5; ++i) {
      const float value = bad[random.below(bad.size())];
      light.texels[4 * random.below(pixels) + random.below(3)] = value;
      if (value > half_max) light.brightest = half_max;
    }
  }
  return light;
}

} // namespace dermis::abi_test
