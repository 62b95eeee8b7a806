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
  return {.name = name, .given = with(damage), .same_as = with(taken)};
}

StabilityCase uniform(std::string_view name, float value, double bound) {
  const double taken = std::min(value, largest_half);
  const auto given = [value](uint32_t) {
    CapturedFrame frame = sound_frame();
    fill_light(frame, value);
    return frame;
  };
  const auto expected = [taken](uint32_t) { return taken; };
  return {.name = name,
          .given = given,
          .expected = expected,
          .bound = bound,
          .scale = std::max(1e-30, taken)};
}

// A white plane that scatters where `has_profile` is true.
template <class Mask> StabilityCase masked(std::string_view name, Mask has_profile) {
  const auto given = [has_profile](uint32_t) {
    CapturedFrame frame = sound_frame();
    for_pixels(frame, [&](uint32_t x, uint32_t y, size_t i) {
      frame.profile[i] = has_profile(x, y) ? 1 : 0;
    });
    return frame;
  };
  return {.name = name, .given = given, .expected = white, .bound = furnace};
}

// Half of the plane is dark and scatters. Light of the other half must reach the dark half.
StabilityCase black_half() {
  const auto with = [](float dark) {
    return [dark](uint32_t) {
      CapturedFrame frame = sound_frame();
      for_pixels(frame, [&](uint32_t x, uint32_t y, size_t) {
        if (is_right_half(x)) set_light(frame, x, y, dark);
      });
      return frame;
    };
  };
  return {
      .name = "black_subsurface", .given = with(0.0f), .same_as = with(1e-6f), .bound = furnace};
}

// Half of the image has no profile and 1000 times the light. None of that light may leak.
StabilityCase glare_beside() {
  const auto given = [](uint32_t) {
    CapturedFrame frame = sound_frame();
    for_pixels(frame, [&](uint32_t x, uint32_t y, size_t i) {
      if (!is_right_half(x)) return;
      set_light(frame, x, y, 1000);
      frame.profile[i] = 0;
    });
    return frame;
  };
  return {.name = "glare_without_profile", .given = given, .expected = white, .bound = furnace};
}

// The brightest light next to darkness, on pixels at many depths, so that dark pixels receive
// almost no light, least in blue. Results must not become negative.
StabilityCase glare_in_the_dark() {
  constexpr float step = 2e-3f; // metres: two d
  const auto given = [](uint32_t frame) {
    CapturedFrame out = sound_frame();
    for_pixels(out, [&](uint32_t x, uint32_t y, size_t i) {
      const uint32_t hash = (31 * x + 17 * y + x * y) % 23;
      set_light(out, x, y, (hash + frame) % 3 == 0 ? largest_half : 0);
      out.depth.at(x, y, 0) = 1 + step * static_cast<float>(hash % 7);
      if (!is_right_half(x)) out.profile[i] = 5;
    });
    return out;
  };
  return {.name = "glare_in_the_dark", .frames = 8, .given = given, .finite_only = true};
}

// Light alternates between 1000 and the next float, long enough for variances to become negative by
// rounding.
StabilityCase trembling() {
  const auto given = [](uint32_t frame) {
    CapturedFrame out = sound_frame();
    for (size_t i = 0; i < out.lighting.values.size(); ++i)
      out.lighting.values[i] = (i + frame) % 2 == 0 ? 1000.0f : std::nextafter(1000.0f, 2000.0f);
    return out;
  };
  return {.name = "light_1000_within_a_step",
          .frames = 32,
          .given = given,
          .expected = [](uint32_t) { return 1000.0; },
          .bound = furnace,
          .scale = 1000};
}

StabilityCase wrong_albedo() {
  const auto given = [](uint32_t) {
    CapturedFrame frame = textured_frame();
    constexpr std::array values{-1.0f, 2.0f, not_a_number, infinity};
    for (size_t i = 0; i < frame.albedo.values.size(); ++i)
      frame.albedo.values[i] = values[i % values.size()];
    return frame;
  };
  return {.name = "albedo_out_of_range", .given = given, .finite_only = true};
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
  subsurface::Profile dipole;
  dipole.name = "dipole";
  dipole.model = subsurface::ProfileModel::dipole;
  dipole.sigma_a = {0.1, 0.2, 0.4};
  dipole.sigma_s_prime = {2, 2, 2};
  subsurface::derive(dipole);
  return {{1, grey_profile()},
          {2, wide},
          {3, with_blue("no_blue", 0)},
          {4, with_blue("narrow_blue", 1e-3)},
          {5, with_blue("blue_of_a_hundredth", 1e-2)},
          {6, dipole}};
}

CapturedFrame sound_frame(uint32_t width, uint32_t height, double d_px) {
  const std::vector<CaptureProfile> profiles = stability_profiles();
  return plane_frame(width, height, d_px, profiles);
}

void set_texture(CapturedFrame& frame) {
  for_pixels(frame, [&](uint32_t x, uint32_t y, size_t) {
    set_light(frame, x, y, static_cast<float>(0.5 + 0.4 * std::sin(x * 0.2) * std::cos(y * 0.3)));
  });
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
  return {
      damaged_light("light_nan", not_a_number, 0),
      damaged_light("light_negative", -1, 0),
      damaged_light("light_minus_infinity", -infinity, 0),
      damaged_light("light_infinity", infinity, largest_half),
      damaged_light("light_beyond_half", 1e30f, largest_half),
      uniform("light_denormal", 1e-40f, 2 * 0x1p-24 / 1e-30), // two steps of a half float
      uniform("light_faint", 1e-4f, 2 * 0x1p-24 / 1e-4),
      uniform("light_brightest", 6e4f, furnace),
      uniform("light_too_bright", 1e6f, furnace),
      trembling(),
      glare_beside(),
      glare_in_the_dark(),
      wrong_albedo(),
      black_half(),
      masked("isolated_pixel", [](uint32_t x, uint32_t y) { return x == 13 && y == 17; }),
      masked("hair_thin_holes", [](uint32_t x, uint32_t y) { return x % 7 != 3 && y % 11 != 5; }),
      masked("checkerboard_mask", [](uint32_t x, uint32_t y) { return (x + y) % 2 == 0; }),
      masked("empty_mask", [](uint32_t, uint32_t) { return false; })};
}

} // namespace dermis::tools
