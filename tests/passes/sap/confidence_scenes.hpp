#pragma once
// Small orthographic scenes with pixels of 1 mm on which the confidence of the surface-aware
// pyramid is tested: some that the pyramid represents exactly, and some with surfaces that it
// mixes.

#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace confidence_scenes {

inline constexpr uint32_t width = 112, height = 88; // Pixels.

struct Scene {
  std::string name;
  double d_px;
  bool represented; // The pyramid represents the surface: no pixel has a low confidence.
  bool refined;     // Also for tests on the device.
  std::function<float(int x, int y)> depth_m = [](int, int) { return 0.5f; };
  std::function<uint8_t(int x, int y)> profile = [](int, int) { return uint8_t{1}; }; // 0, 1 or 2.
};

inline float hashed(uint32_t x, uint32_t y) { // Deterministic, in [0, 1).
  uint32_t h = x * 0x9e3779b9u ^ (y + 0x7f4a7c15u) * 0x85ebca6bu;
  h ^= h >> 15;
  h *= 0x2c1b3c6du;
  h ^= h >> 13;
  return float(h >> 8) / 16777216.0f;
}

// Contrasts of 1, 4 and 16 pixels, and bars.
inline float light(uint32_t x, uint32_t y) {
  const float bars = (x / 7 + y / 11) % 3 == 0 ? 0.3f : 0.0f;
  return 0.1f + 0.25f * hashed(x / 16, y / 16) + 0.2f * hashed(x / 4 + 77, y / 4) +
         0.1f * hashed(x, y + 99) + bars;
}

// A depth of 0.5 m minus a height in pixels.
inline float above(double height_px) {
  return float(0.5 - 1e-3 * height_px);
}

inline std::vector<Scene> all() {
  const auto folded = [](int x, int period) { // Distance from a ridge, pixels.
    return std::abs(std::fmod(double(x) + 0.5, double(period)) - 0.5 * period);
  };
  std::vector<Scene> scenes;
  const auto add = [&](std::string name, double d_px, bool represented,
                       bool refined = false) -> Scene& {
    scenes.push_back(
        {.name = std::move(name), .d_px = d_px, .represented = represented, .refined = refined});
    return scenes.back();
  };
  add("plane_d1", 1, true);
  add("plane_d6", 6, true);
  add("plane_d40", 40, true, true);
  add("strips", 6, true).profile = [](int x, int) { return uint8_t(x % 12 < 6); };
  add("checker_mask", 4, true, true).profile = [](int x, int y) { return uint8_t((x + y) % 2); };
  add("holes", 8, true).profile = [](int x, int y) { return uint8_t(x % 9 > 2 || y % 9 > 2); };
  add("tilt_60", 6, true, true).depth_m = [](int x, int) { return above(1.732 * x); };
  add("ramp", 3, true).depth_m = [](int x, int y) { return above(0.5 * x + 0.3 * y); };
  add("far_step", 2, true).depth_m = [](int x, int) { return x < 50 ? 0.5f : 1.5f; };
  add("zigzag_56", 6, false, true).depth_m = [=](int x, int) {
    return above(1.483 * folded(x, 16));
  };
  add("zigzag_35", 6, false, true).depth_m = [=](int x, int y) {
    return above(0.7 * folded(x + y / 2, 12));
  };
  add("grooves", 4, false).depth_m = [](int x, int) { return above(x % 12 < 6 ? 12 : 0); };
  add("steps", 8, false, true).depth_m = [](int x, int y) {
    return above(5 * (x / 14) + 3 * (y / 19));
  };
  add("waves", 6, false).depth_m = [](int x, int y) {
    return above(4 * std::sin(0.55 * x) * std::cos(0.4 * y));
  };
  add("hair", 6, false, true).depth_m = [](int x, int y) {
    return above((x + y / 5) % 9 == 0 ? 20 : 0);
  };
  add("checker_two", 4, true).profile = [](int x, int y) { return uint8_t(1 + (x + y) % 2); };
  add("dither", 6, false).depth_m = [](int x, int y) { return above((x + y) % 2 == 0 ? 12 : 0); };
  add("rough", 4, false).depth_m = [](int x, int y) {
    return above(3 * hashed(uint32_t(x), uint32_t(y)));
  };
  return scenes;
}

} // namespace confidence_scenes
