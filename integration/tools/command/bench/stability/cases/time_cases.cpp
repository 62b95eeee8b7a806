// Sequences: damage that history must not keep, jumps of light and profiles, large frame numbers.
#include "integration/tools/command/bench/stability/cases.hpp"

#include "framegraph/model/splitmix.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dermis::tools {
namespace {

using Level = std::function<double(uint32_t frame)>;

// White light whose level changes per frame.
StabilityCase levels(std::string_view name, uint32_t frames, Level level, double scale) {
  const auto given = [level](uint32_t frame) {
    CapturedFrame out = sound_frame();
    fill_light(out, static_cast<float>(level(frame)));
    return out;
  };
  return {.name = name,
          .frames = frames,
          .given = given,
          .expected = level,
          .bound = furnace,
          .scale = scale};
}

// Frame 4 is all NaN.
StabilityCase poisoned() {
  StabilityCase made = levels(
      "history_poisoned", 12,
      [](uint32_t frame) { return frame == 4 ? double(not_a_number) : 1.0; }, 1);
  made.expected = [](uint32_t frame) { return frame == 4 ? 0.0 : 1.0; };
  made.damage_ends = 5;
  return made;
}

// Two profiles swap their halves at frame 5.
StabilityCase swapped_profiles() {
  const auto given = [](uint32_t frame) {
    CapturedFrame out = sound_frame();
    for_pixels(out, [&](uint32_t x, uint32_t, size_t i) {
      out.profile[i] = is_right_half(x) == (frame < 5) ? 2 : 1;
    });
    return out;
  };
  return {
      .name = "profiles_change", .frames = 10, .given = given, .expected = white, .bound = furnace};
}

StabilityCase vanishing() {
  const auto given = [](uint32_t frame) {
    CapturedFrame out = sound_frame();
    if (frame % 3 == 1) std::fill(out.profile.begin(), out.profile.end(), uint8_t{0});
    return out;
  };
  return {.name = "subsurface_comes_and_goes",
          .frames = 9,
          .given = given,
          .expected = white,
          .bound = furnace};
}

StabilityCase exposed() {
  StabilityCase made = levels(
      "exposure_x16", 24, [](uint32_t frame) { return frame >= 8 && frame < 16 ? 16.0 : 1.0; }, 16);
  made.given = [given = made.given, level = made.expected](uint32_t frame) {
    CapturedFrame out = given(frame);
    out.description.exposure = 1 / level(frame);
    return out;
  };
  return made;
}

// Frame numbers near the limits of float, signed and unsigned integers. Results may differ from
// those of the first frames (`same_as`) only by noise.
StabilityCase frame_number(std::string_view name, uint64_t index) {
  const auto textured = [](uint32_t) { return textured_frame(); };
  return {.name = name,
          .frames = 3,
          .given = textured,
          .same_as = textured,
          .metric = Metric::light_rms,
          // For light in 0.1..0.9: noise of two frames with 16 samples, 0.057 for the noisiest
          // technique.
          .bound = 0.08,
          .frame_index = index};
}

double jitter(uint32_t frame) {
  SplitMix64 random{frame + 1};
  return 1 + 0.02 * (2 * (static_cast<double>(random.next() >> 11) * 0x1p-53) - 1);
}

} // namespace

std::vector<StabilityCase> time_cases() {
  StabilityCase cuts = levels(
      "cut_every_frame", 6, [](uint32_t frame) { return frame % 2 == 0 ? 1.0 : 0.25; }, 1);
  cuts.follows = false;
  return {
      poisoned(),
      levels(
          "dark_then_flash", 34, [](uint32_t frame) { return frame < 30 ? 0.0 : 1.0; }, 1),
      levels(
          "bright_then_black", 34, [](uint32_t frame) { return frame < 30 ? 1000.0 : 0.0; }, 1000),
      levels("jitter_2_percent", 40, jitter, 1),
      exposed(),
      swapped_profiles(),
      vanishing(),
      cuts,
      frame_number("frame_index_2^24", (1ull << 24) - 1),
      frame_number("frame_index_2^31", (1ull << 31) - 1),
      frame_number("frame_index_2^32", (1ull << 32) - 2),
      frame_number("frame_index_2^40", 1ull << 40)};
}

} // namespace dermis::tools
