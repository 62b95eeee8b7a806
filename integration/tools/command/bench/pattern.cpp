#include "integration/tools/command/bench/pattern.hpp"

#include <algorithm>
#include <cmath>

namespace dermis::tools {

float hashed(uint32_t x, uint32_t y) {
  uint32_t h = x * 0x9e3779b9u ^ (y + 0x7f4a7c15u) * 0x85ebca6bu;
  h ^= h >> 15;
  h *= 0x2c1b3c6du;
  h ^= h >> 13;
  return static_cast<float>(h >> 8) / 16777216.0f;
}

double texture(Place p) {
  const auto x = static_cast<uint32_t>(std::max(0.0, p.x + 0.5)),
             y = static_cast<uint32_t>(std::max(0.0, p.y + 0.5));
  double value = 0.2 + 0.3 * double(hashed(x / 32, y / 32)) +
                 0.2 * double(hashed(x / 8 + 77, y / 8)) + 0.1 * double(hashed(x, y + 99));
  // One disc per cell of 80 pixels, of random brightness and a radius of up to half the cell.
  const uint32_t cx = x / 80, cy = y / 80;
  const double radius = 4 + 34 * double(hashed(cx, cy + 3)) * double(hashed(cx + 5, cy));
  const double ox = cx * 80 + 40.0 + 20 * (double(hashed(cx + 11, cy)) - 0.5);
  const double oy = cy * 80 + 40.0 + 20 * (double(hashed(cx, cy + 17)) - 0.5);
  if (std::hypot(p.x - ox, p.y - oy) < radius) value = double(hashed(cx + 23, cy + 29));
  // A checkerboard in one corner provides axis-aligned edges.
  return x < 160 && y >= 240 && y < 360 ? double(((x / 20) + (y / 20)) % 2) : value;
}

double shade(double slope_x, double slope_y) {
  constexpr double to_light[3] = {-0.66, -0.42, 0.62}; // y points down, as in pixels
  const double facing = (-slope_x * to_light[0] - slope_y * to_light[1] + to_light[2]) /
                        std::sqrt(1 + slope_x * slope_x + slope_y * slope_y);
  return 0.05 + 0.95 * std::max(0.0, facing);
}

} // namespace dermis::tools
