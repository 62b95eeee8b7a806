// Invalid light and masks.
#include "integration/tools/command/bench/stability/cases.hpp"

#include "integration/tools/command/bench/subject.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dermis::tools {
namespace {

constexpr float largest_half = 65504; // upper bound of clean_light in shaders/common/sanitise.glsl

// Three pixels of the textured frame hold `damage`, which must have the effect of `taken`.
StabilityCase damaged_light(std::string_view name, float damage, float taken) {
  const auto with = [](float value) {
    return [value](uint32_t) {
      CapturedFrame frame = textured_frame();
      for (uint32_t y = 20; y < 23; ++y)
        set_light(frame, 20, y, value);
      return frame;
    };
  };
  StabilityCase made;
  made.name = name;
  made.given = with(damage);
  made.same_as = with(taken);
  return made;
}

StabilityCase uniform(std::string_view name, float value, double bound) {
  StabilityCase made;
  made.name = name;
  made.given = [value](uint32_t) {
    CapturedFrame frame = sound_frame();
    fill_light(frame, value);
    return frame;
  };
  made.wanted = [value](uint32_t) { return double(std::min(value, largest_half)); };
  made.scale = std::max(1e-30, double(std::min(value, largest_half)));
  made.bound = bound;
  return made;
}

// A white plane that scatters where `has_profile` is true.
template <class Mask> StabilityCase masked(std::string_view name, Mask has_profile) {
  StabilityCase made;
  made.name = name;
  made.given = [has_profile](uint32_t) {
    CapturedFrame frame = sound_frame();
    for (uint32_t y = 0; y < stability_side; ++y)
      for (uint32_t x = 0; x < stability_side; ++x)
        frame.profile[y * stability_side + x] = has_profile(x, y) ? 1 : 0;
    return frame;
  };
  made.wanted = [](uint32_t) { return 1.0; };
  made.bound = furnace;
  return made;
}

// Half of the plane is dark and scatters. Light of the other half must reach the dark half.
StabilityCase black_half() {
  const auto with = [](float dark) {
    return [dark](uint32_t) {
      CapturedFrame frame = sound_frame();
      for (uint32_t y = 0; y < stability_side; ++y)
        for (uint32_t x = stability_side / 2; x < stability_side; ++x)
          set_light(frame, x, y, dark);
      return frame;
    };
  };
  StabilityCase made;
  made.name = "black_subsurface";
  made.given = with(0.0f);
  made.same_as = with(1e-6f);
  made.bound = furnace;
  return made;
}

// Half of the image has no profile and 1000 times the light. None of that light may leak.
StabilityCase glare_beside() {
  StabilityCase made;
  made.name = "glare_without_profile";
  made.given = [](uint32_t) {
    CapturedFrame frame = sound_frame();
    for (uint32_t y = 0; y < stability_side; ++y)
      for (uint32_t x = stability_side / 2; x < stability_side; ++x) {
        set_light(frame, x, y, 1000);
        frame.profile[y * stability_side + x] = 0;
      }
    return frame;
  };
  made.wanted = [](uint32_t) { return 1.0; };
  made.bound = furnace;
  return made;
}

// The brightest light next to darkness, on pixels at many depths, so that dark pixels receive
// almost no light, least in blue. Results must not become negative.
StabilityCase glare_in_the_dark() {
  constexpr float step = 2e-3f; // metres: two d
  StabilityCase made;
  made.name = "glare_in_the_dark";
  made.frames = 8;
  made.given = [](uint32_t frame) {
    CapturedFrame out = sound_frame();
    for (uint32_t y = 0; y < stability_side; ++y)
      for (uint32_t x = 0; x < stability_side; ++x) {
        const uint32_t hash = (31 * x + 17 * y + x * y) % 23;
        set_light(out, x, y, (hash + frame) % 3 == 0 ? largest_half : 0);
        out.depth.at(x, y, 0) = 1 + step * static_cast<float>(hash % 7);
        if (x < stability_side / 2) out.profile[y * stability_side + x] = 5;
      }
    return out;
  };
  made.finite_only = true;
  return made;
}

// Light alternates between 1000 and the next float, long enough for variances to become negative by
// rounding.
StabilityCase trembling() {
  StabilityCase made;
  made.name = "light_1000_within_a_step";
  made.frames = 32;
  made.given = [](uint32_t frame) {
    CapturedFrame out = sound_frame();
    for (size_t i = 0; i < out.lighting.values.size(); ++i)
      out.lighting.values[i] = (i + frame) % 2 == 0 ? 1000.0f : std::nextafter(1000.0f, 2000.0f);
    return out;
  };
  made.wanted = [](uint32_t) { return 1000.0; };
  made.scale = 1000;
  made.bound = furnace;
  return made;
}

} // namespace

std::vector<CaptureProfile> stability_profiles() {
  subsurface::Profile wide = grey_profile();
  wide.name = "wide";
  for (double& dmfp : wide.dmfp_mm)
    dmfp *= 2;
  subsurface::derive(wide);
  const auto with_blue = [](std::string name, double fraction) {
    subsurface::Profile made = grey_profile();
    made.name = std::move(name);
    made.dmfp_mm[2] *= fraction;
    subsurface::derive(made);
    return made;
  };
  return {{1, grey_profile()},
          {2, wide},
          {3, with_blue("no_blue", 0)},
          {4, with_blue("narrow_blue", 1e-3)},
          {5, with_blue("blue_of_a_hundredth", 1e-2)}};
}

CapturedFrame sound_frame(uint32_t width, uint32_t height, double d_px) {
  const std::vector<CaptureProfile> profiles = stability_profiles();
  return plane_frame(width, height, d_px, profiles);
}

void set_texture(CapturedFrame& frame) {
  for (uint32_t y = 0; y < frame.description.height; ++y)
    for (uint32_t x = 0; x < frame.description.width; ++x)
      set_light(frame, x, y, static_cast<float>(0.5 + 0.4 * std::sin(x * 0.2) * std::cos(y * 0.3)));
}

CapturedFrame textured_frame() {
  CapturedFrame frame = sound_frame();
  set_texture(frame);
  return frame;
}

void set_light(CapturedFrame& frame, uint32_t x, uint32_t y, float value) {
  for (uint32_t c = 0; c < 3; ++c)
    frame.lighting.at(x, y, c) = value;
}

void fill_light(CapturedFrame& frame, float value) {
  std::fill(frame.lighting.values.begin(), frame.lighting.values.end(), value);
}

std::vector<StabilityCase> light_cases() {
  StabilityCase albedo;
  albedo.name = "albedo_out_of_range";
  albedo.given = [](uint32_t) {
    CapturedFrame frame = textured_frame();
    constexpr std::array values{-1.0f, 2.0f, not_a_number, infinity};
    for (size_t i = 0; i < frame.albedo.values.size(); ++i)
      frame.albedo.values[i] = values[i % values.size()];
    return frame;
  };
  albedo.finite_only = true;
  return {damaged_light("light_nan", not_a_number, 0),
          damaged_light("light_negative", -1, 0),
          damaged_light("light_minus_infinity", -infinity, 0),
          damaged_light("light_infinity", infinity, largest_half),
          damaged_light("light_beyond_half", 1e30f, largest_half),
          uniform("light_denormal", 1e-40f, 1e30), // may become 0
          uniform("light_faint", 1e-4f, 4e-3),     // half floats are 6e-8 apart below 6e-5
          uniform("light_brightest", 6e4f, furnace),
          uniform("light_too_bright", 1e6f, furnace),
          trembling(),
          glare_beside(),
          glare_in_the_dark(),
          albedo,
          black_half(),
          masked("isolated_pixel", [](uint32_t x, uint32_t y) { return x == 13 && y == 17; }),
          masked("hair_thin_holes", [](uint32_t x, uint32_t y) { return x % 7 != 3 && y % 11 != 5; }),
          masked("checkerboard_mask", [](uint32_t x, uint32_t y) { return (x + y) % 2 == 0; }),
          masked("empty_mask", [](uint32_t, uint32_t) { return false; })};
}

} // namespace dermis::tools
