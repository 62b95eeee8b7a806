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
StabilityCase levels(std::string_view name, uint32_t frames, Level level, double scale,
                     double bound = furnace) {
  StabilityCase made;
  made.name = name;
  made.frames = frames;
  made.given = [level](uint32_t frame) {
    CapturedFrame made_frame = sound_frame();
    fill_light(made_frame, static_cast<float>(level(frame)));
    return made_frame;
  };
  made.wanted = level;
  made.scale = scale;
  made.bound = bound;
  return made;
}

// Frame 4 is all NaN.
StabilityCase poisoned() {
  StabilityCase made;
  made.name = "history_poisoned";
  made.frames = 12;
  made.given = [](uint32_t frame) {
    CapturedFrame out = sound_frame();
    if (frame == 4) fill_light(out, not_a_number);
    return out;
  };
  made.wanted = [](uint32_t frame) { return frame == 4 ? 0.0 : 1.0; };
  made.bound = furnace;
  made.damage_ends = 5;
  return made;
}

// Two profiles swap their halves at frame 5.
StabilityCase swapped_profiles() {
  StabilityCase made;
  made.name = "profiles_change";
  made.frames = 10;
  made.given = [](uint32_t frame) {
    CapturedFrame out = sound_frame();
    for (uint32_t y = 0; y < stability_side; ++y)
      for (uint32_t x = 0; x < stability_side; ++x)
        out.profile[y * stability_side + x] = (x < stability_side / 2) == (frame < 5) ? 1 : 2;
    return out;
  };
  made.wanted = [](uint32_t) { return 1.0; };
  made.bound = furnace;
  return made;
}

// Frame numbers near the limits of float, signed and unsigned integers. Results may differ from
// those of the first frames (`same_as`) only by noise.
StabilityCase frame_number(std::string_view name, uint64_t index) {
  StabilityCase made;
  made.name = name;
  made.frames = 3;
  made.given = made.same_as = [](uint32_t) { return textured_frame(); };
  made.frame_index = index;
  made.judged = Judged::light_rms;
  // For light in 0.1..0.9: noise of two frames with 16 samples, 0.057 for the noisiest technique.
  made.bound = 0.08;
  return made;
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
  StabilityCase vanishing;
  vanishing.name = "subsurface_comes_and_goes";
  vanishing.frames = 9;
  vanishing.given = [](uint32_t frame) {
    CapturedFrame out = sound_frame();
    if (frame % 3 == 1) std::fill(out.profile.begin(), out.profile.end(), uint8_t{0});
    return out;
  };
  vanishing.wanted = [](uint32_t) { return 1.0; };
  vanishing.bound = furnace;
  StabilityCase exposure = levels(
      "exposure_x16", 24, [](uint32_t frame) { return frame >= 8 && frame < 16 ? 16.0 : 1.0; }, 16);
  exposure.given = [](uint32_t frame) {
    const double level = frame >= 8 && frame < 16 ? 16.0 : 1.0;
    CapturedFrame out = sound_frame();
    fill_light(out, static_cast<float>(level));
    out.description.exposure = 1 / level;
    return out;
  };
  return {poisoned(),
          levels(
              "dark_then_flash", 34, [](uint32_t frame) { return frame < 30 ? 0.0 : 1.0; }, 1),
          levels(
              "bright_then_black", 34, [](uint32_t frame) { return frame < 30 ? 1000.0 : 0.0; }, 1000),
          levels("jitter_2_percent", 40, jitter, 1),
          exposure,
          swapped_profiles(),
          vanishing,
          cuts,
          frame_number("frame_index_2^24", (1ull << 24) - 1),
          frame_number("frame_index_2^31", (1ull << 31) - 1),
          frame_number("frame_index_2^32", (1ull << 32) - 2),
          frame_number("frame_index_2^40", 1ull << 40)};
}

} // namespace dermis::tools
