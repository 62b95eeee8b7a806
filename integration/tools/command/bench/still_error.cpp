#include "integration/tools/command/bench/still_error.hpp"

#include "integration/examples/demo_engine/engine.hpp"

#include <algorithm>

namespace dermis::tools {
namespace {

// Returns the measured pixels exposed and tonemapped.
template <class Value> std::vector<uint8_t> shown(size_t count, double exposure, Value&& value) {
  demo::FloatImage image{static_cast<uint32_t>(count), 1, 3, {}};
  for (size_t i = 0; i < 3 * count; ++i)
    image.texels.push_back(static_cast<float>(value(i) * exposure));
  return demo::tonemap(image);
}

} // namespace

StillError still_error(std::span<const float> light, const Reference& reference) {
  StillError error;
  error.population = reference.population;
  error.figures =
      measure_error(light, reference.light, reference.pixels, reference.exposure, reference.population);
  const size_t count = reference.pixels.size();
  const auto here = shown(count, reference.exposure, [&](size_t i) {
    return double(light[size_t{3} * reference.pixels[i / 3] + i % 3]);
  });
  const auto exact = shown(count, reference.exposure, [&](size_t i) { return reference.light[i]; });
  double squares = 0;
  for (size_t i = 0; i < here.size(); ++i)
    squares += (double(here[i]) - exact[i]) * (double(here[i]) - exact[i]);
  error.psnr_db_sdr8 = psnr_from_mse(here.empty() ? 0 : squares / (255.0 * 255.0 * double(here.size())));
  return error;
}

double psnr_between(std::span<const float> light, std::span<const float> other, const Reference& reference) {
  std::vector<double> values;
  for (const uint32_t pixel : reference.pixels)
    for (size_t c = 0; c < 3; ++c)
      values.push_back(double(other[size_t{3} * pixel + c]));
  return measure_error(light, values, reference.pixels, reference.exposure, reference.population).psnr_db;
}

CapturedFrame window_of(const CapturedFrame& frame, uint32_t side) {
  CapturedFrame window = frame;
  FrameDescription& description = window.description;
  if (side == 0) return window;
  const uint32_t width = std::min(side, description.width), height = std::min(side, description.height);
  description.render = {(description.width - width) / 2, (description.height - height) / 2, width, height};
  return window;
}

Reference inside(const CapturedFrame& frame, const Reference& whole) {
  const auto& render = frame.description.render;
  Reference part;
  part.exposure = whole.exposure;
  for (const uint32_t pixel : whole.pixels) {
    const uint32_t x = pixel % frame.description.width, y = pixel / frame.description.width;
    if (x >= render.x && x < render.x + render.width && y >= render.y && y < render.y + render.height)
      part.pixels.push_back(pixel);
  }
  return part;
}

} // namespace dermis::tools
