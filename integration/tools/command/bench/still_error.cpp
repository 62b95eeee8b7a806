#include "integration/tools/command/bench/still_error.hpp"

#include "integration/examples/demo_engine/engine.hpp"

#include <algorithm>

namespace dermis::tools {
namespace {

std::vector<uint8_t> shown(std::span<const double> light, double exposure) {
  demo::FloatImage image{static_cast<uint32_t>(light.size() / 3), 1, 3, {}};
  for (const double value : light)
    image.texels.push_back(static_cast<float>(value * exposure));
  return demo::tonemap(image);
}

// Returns the values at the reference's pixels.
std::vector<double> at_pixels(std::span<const float> light, const Reference& reference) {
  std::vector<double> values;
  for (const uint32_t pixel : reference.pixels)
    for (size_t c = 0; c < 3; ++c)
      values.push_back(double(light[size_t{3} * pixel + c]));
  return values;
}

} // namespace

double sdr8_mse(std::span<const double> light, std::span<const double> reference, double exposure) {
  const std::vector<uint8_t> here = shown(light, exposure), there = shown(reference, exposure);
  double squares = 0;
  for (size_t i = 0; i < here.size(); ++i) {
    const double difference = (double(here[i]) - double(there[i])) / 255.0;
    squares += difference * difference;
  }
  return here.empty() ? 0 : squares / double(here.size());
}

StillError still_error(std::span<const float> light, const Reference& reference) {
  StillError error;
  error.population = reference.population;
  error.figures = measure_error(light, reference.light, reference.pixels, reference.exposure,
                                reference.population);
  error.psnr_db_sdr8 =
      psnr_from_mse(sdr8_mse(at_pixels(light, reference), reference.light, reference.exposure));
  return error;
}

double psnr_between(std::span<const float> light, std::span<const float> other,
                    const Reference& reference) {
  return measure_error(light, at_pixels(other, reference), reference.pixels, reference.exposure,
                       reference.population)
      .psnr_db;
}

CapturedFrame window_of(const CapturedFrame& frame, uint32_t side) {
  CapturedFrame window = frame;
  FrameDescription& description = window.description;
  if (side == 0) return window;
  const uint32_t width = std::min(side, description.width),
                 height = std::min(side, description.height);
  description.render = {(description.width - width) / 2, (description.height - height) / 2, width,
                        height};
  return window;
}

Reference inside(const CapturedFrame& frame, const Reference& whole) {
  const auto& render = frame.description.render;
  Reference part;
  part.exposure = whole.exposure;
  for (const uint32_t pixel : whole.pixels) {
    const uint32_t x = pixel % frame.description.width, y = pixel / frame.description.width;
    if (x >= render.x && x < render.x + render.width && y >= render.y &&
        y < render.y + render.height)
      part.pixels.push_back(pixel);
  }
  return part;
}

} // namespace dermis::tools
