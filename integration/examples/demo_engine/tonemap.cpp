#include "integration/examples/demo_engine/engine.hpp"
#include "integration/examples/demo_engine/pixel_format.hpp"

#include <algorithm>
#include <cmath>

namespace demo {
namespace {

// Narkowicz 2016: x(ax + b) / (x(cx + d) + e); the curve expects an exposure factor of 0.6.
float filmic(float x) {
  constexpr float a = 2.51f, b = 0.03f, c = 2.43f, d = 0.59f, e = 0.14f, exposure = 0.6f;
  const float v = std::max(0.0f, x) * exposure;
  return std::clamp(v * (a * v + b) / (v * (c * v + d) + e), 0.0f, 1.0f);
}

} // namespace

std::vector<uint8_t> tonemap(const FloatImage& linear_rgb) {
  std::vector<uint8_t> display(linear_rgb.texels.size());
  for (size_t i = 0; i < display.size(); ++i) {
    const float value = linear_rgb.texels[i];
    const float finite = std::isfinite(value) ? value : 0.0f;
    display[i] = static_cast<uint8_t>(std::lround(255.0f * srgb_from_linear(filmic(finite))));
  }
  return display;
}

} // namespace demo
