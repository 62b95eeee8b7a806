// Sequences that mislead history: invalid velocities, and light that invalidates learned values.
#include "integration/tools/command/bench/stability/cases.hpp"

#include <algorithm>
#include <array>
#include <limits>

namespace dermis::tools {
namespace {

using Velocity = std::array<float, 3>; // pixels to the right, down; units of view depth
constexpr Velocity rests{0, 0, 0};
// of any image here: marks a surface that was not visible
constexpr Velocity leads_outside{1e3f, 0, 0};

StabilityCase velocity(std::string_view name, float value) {
  const auto given = [value](uint32_t) {
    CapturedFrame frame = sound_frame();
    frame.velocity = Image::sized(stability_side, stability_side, 2);
    std::fill(frame.velocity.values.begin(), frame.velocity.values.end(), value);
    return frame;
  };
  return {.name = name,
          .frames = 4,
          .given = given,
          .expected = white,
          .applies_to = AppliesTo::with_history,
          .bound = furnace};
}

// Stripes of invalid velocities alternate with resting stripes, under varying light. A pixel with
// an invalid velocity must count as not visible before.
StabilityCase striped(std::string_view name, std::array<Velocity, 3> broken) {
  const auto with = [broken](bool damaged) {
    return [broken, damaged](uint32_t) {
      constexpr uint32_t stripe = 8; // pixels
      CapturedFrame frame = textured_frame();
      frame.velocity = Image::sized(stability_side, stability_side, 3);
      for_pixels(frame, [&](uint32_t x, uint32_t y, size_t) {
        const uint32_t number = x / stripe;
        const Velocity there = damaged ? broken[number / 2] : leads_outside;
        for (uint32_t c = 0; c < 3; ++c)
          frame.velocity.at(x, y, c) = (number % 2 == 0 ? there : rests)[c];
      });
      return frame;
    };
  };
  return {.name = name,
          .frames = 5,
          .given = with(true),
          .same_as = with(false),
          .applies_to = AppliesTo::with_history};
}

// Terraces on which pyramids have low confidence. First red light falls on a single pixel, where
// samples find many times the pyramid's light. Then it falls on all pixels while the pattern of the
// luminance stays, so that the learned ratios are trusted.
StabilityCase red_comes() {
  constexpr uint32_t comes = 8;               // frame
  constexpr uint32_t terrace = 6;             // pixels
  constexpr float level = 0.5f, step = 2e-3f; // metres: two d
  constexpr double largest_ratio = 4;         // shaders/papers/subsurface_residual.comp
  const auto given = [](uint32_t frame) {
    CapturedFrame out = sound_frame();
    fill_light(out, level);
    for_pixels(out, [&](uint32_t x, uint32_t y, size_t) {
      out.depth.at(x, y, 0) = 1 + step * static_cast<float>((x / terrace + y / terrace) % 2);
      if (frame < comes) out.lighting.at(x, y, 0) = x == 24 && y == 24 ? 1.0f : 0.0f;
    });
    return out;
  };
  return {.name = "red_comes",
          .frames = 16,
          .given = given,
          .expected = [](uint32_t) { return double(level); },
          .applies_to = AppliesTo::with_history,
          .bound = largest_ratio - 1,
          .scale = level,
          .first_judged = comes};
}

} // namespace

std::vector<StabilityCase> motion_cases() {
  return {velocity("velocity_nan", not_a_number),
          velocity("velocity_infinity", infinity),
          velocity("velocity_1e6_px", 1e6f),
          striped("velocity_in_stripes",
                  {{{not_a_number, 0, 0}, {infinity, -infinity, 0}, {0x1p31f, 1e30f, 0}}}),
          striped("velocity_of_depth_in_stripes",
                  {{{0, 0, -infinity}, {0, 0, not_a_number}, {0, 0, -1e30f}}}),
          red_comes()};
}

} // namespace dermis::tools
