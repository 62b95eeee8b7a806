// Distances, slopes, sizes and radii at their limits.
#include "integration/tools/command/bench/stability/cases.hpp"

#include "passes/common/pass_types.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace dermis::tools {
namespace {

StabilityCase furnace_of(std::string_view name, std::function<CapturedFrame()> make) {
  return {.name = name,
          .given = [make = std::move(make)](uint32_t) { return make(); },
          .expected = white,
          .bound = furnace};
}

// A plane tilted by `degrees` about the vertical axis.
StabilityCase grazing(std::string_view name, double degrees) {
  return furnace_of(name, [degrees] {
    CapturedFrame frame = sound_frame();
    const double slope =
        std::tan(degrees * 3.14159265358979323846 / 180) * *frame.description.pixel_pitch_m;
    for_pixels(frame, [&](uint32_t x, uint32_t y, size_t) {
      frame.depth.at(x, y, 0) = static_cast<float>(1 + slope * x);
    });
    return frame;
  });
}

StabilityCase sized(std::string_view name, uint32_t width, uint32_t height) {
  return furnace_of(name, [width, height] { return sound_frame(width, height); });
}

CapturedFrame with_scale(CapturedFrame frame, float scale) {
  frame.scatter_scale = Image::sized(frame.description.width, frame.description.height, 1);
  std::fill(frame.scatter_scale.values.begin(), frame.scatter_scale.values.end(), scale);
  return frame;
}

// A factor on d that removes scattering: light must stay unchanged bit for bit.
StabilityCase without_scattering(std::string_view name, float scale) {
  const auto with = [](float factor) {
    return [factor](uint32_t) { return with_scale(textured_frame(), factor); };
  };
  return {.name = name, .given = with(scale), .same_as = with(0)};
}

CapturedFrame with_profile(CapturedFrame frame, uint8_t id) {
  std::fill(frame.profile.begin(), frame.profile.end(), id);
  return frame;
}

// One pixel of a tabulated profile has a factor on d whose square is below the float range. History
// is read between texels, so that what it holds for the pixel reaches others.
StabilityCase one_tiny_scale() {
  const auto with = [](float factor) {
    return [factor](uint32_t) {
      CapturedFrame frame = with_scale(with_profile(textured_frame(), 6), 1);
      frame.scatter_scale.at(stability_side / 2, stability_side / 2, 0) = factor;
      frame.velocity = Image::sized(stability_side, stability_side, 2);
      for (size_t i = 0; i < frame.velocity.values.size(); ++i)
        frame.velocity.values[i] = i % 2 == 0 ? 0.37f : 0.26f;
      return frame;
    };
  };
  return {
      .name = "scatter_scale_1e-30_alone", .frames = 12, .given = with(1e-30f), .same_as = with(0)};
}

// Neighbouring pixels differ in depth by d or more; blue has a hundredth of d. Weights of
// neighbours are at the limit of the float range.
StabilityCase far_apart() {
  return furnace_of("surfaces_far_apart", [] {
    constexpr float step = 3e-3f; // metres: three d
    CapturedFrame frame = with_profile(sound_frame(stability_side, stability_side, 1000), 5);
    for (uint32_t i = 0; i < frame.depth.values.size(); ++i)
      frame.depth.values[i] = 1 + step * static_cast<float>(i * 37 % 251);
    return frame;
  });
}

// Light alternates per pixel and d is just wide enough to scatter, as when a camera approaches.
StabilityCase begins_to_scatter() {
  // fraction of the light beyond the pixel's inscribed circle, 9.16 d
  constexpr double leaves = 0.0354;
  // weight of one of 16 samples if all radii are sampled, as in burley
  constexpr double sample = 1.0 / 16.0;
  const auto given = [](uint32_t) {
    CapturedFrame frame = with_scale(
        sound_frame(), static_cast<float>(1.001 * subsurface::copy_below_d_px / stability_d_px));
    for_pixels(frame, [&](uint32_t x, uint32_t y, size_t) {
      set_light(frame, x, y, (x + y) % 2 == 0 ? 1.0f : 0.0f);
    });
    return frame;
  };
  return {.name = "d_begins_to_scatter",
          .given = given,
          .applies_to = AppliesTo::of_profile,
          .bound = std::max(leaves, sample) + furnace};
}

// The size changes in each frame while histories continue.
StabilityCase resized() {
  const auto given = [](uint32_t frame) {
    constexpr std::array<uint32_t, 4> widths{48, 31, 64, 17};
    return sound_frame(widths[frame % widths.size()], widths[(frame + 1) % widths.size()]);
  };
  return {.name = "size_changes_every_frame",
          .frames = 8,
          .given = given,
          .expected = white,
          .bound = furnace};
}

} // namespace

std::vector<StabilityCase> shape_cases() {
  StabilityCase widest = sized("size_16384x64", 16384, 64),
                odd = sized("size_1919x1079", 1919, 1079);
  odd.large = true;
  // at the border of images, the last columns do not fit on the device
  widest.may_be_rejected = true;
  return {grazing("grazing_85", 85),
          grazing("grazing_89", 89),
          grazing("grazing_89_9", 89.9),
          sized("size_1x1", 1, 1),
          sized("size_1x7", 1, 7),
          sized("size_131x3", 131, 3),
          sized("size_8191x3", 8191, 3),
          odd,
          widest,
          resized(),
          without_scattering("d_1e-30", 1e-30f),
          without_scattering("d_1e-6", 1e-6f),
          // profile 3: blue must be unchanged next to red and green, which scatter
          {.name = "d_0_of_blue",
           .given = [](uint32_t) { return with_profile(textured_frame(), 3); },
           .first_channel = 2},
          // profile 4: blue has a thousandth of the width, so that samples for red contain no
          // information for blue
          furnace_of("d_of_blue_1e-3", [] { return with_profile(sound_frame(), 4); }),
          far_apart(),
          begins_to_scatter(),
          without_scattering("scatter_scale_negative", -1),
          without_scattering("scatter_scale_nan", not_a_number),
          without_scattering("scatter_scale_infinity", infinity),
          one_tiny_scale(),
          furnace_of("d_1e4_px", [] {
            return with_scale(sound_frame(), static_cast<float>(1e4 / stability_d_px));
          })};
}

} // namespace dermis::tools
