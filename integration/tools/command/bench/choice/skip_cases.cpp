#include "integration/tools/command/bench/choice/skip_cases.hpp"

#include "framegraph/model/splitmix.hpp"
#include "integration/tools/command/bench/subject.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dermis::tools {
namespace {

constexpr double subpixel_d_px = 0.03; // below copy_below_d_px
constexpr double covered = 0.05;       // fraction of the pixels

void paint_noise(CapturedFrame& frame) {
  SplitMix64 random{1};
  for (float& value : frame.lighting.values)
    value = 0.25f + 0.75f * static_cast<float>(random.next() >> 40) / float(1u << 24);
}

void cut_disc(CapturedFrame& frame, double fraction) {
  const uint32_t width = frame.description.width, height = frame.description.height;
  const double radius = std::sqrt(fraction * width * height / std::numbers::pi);
  for (uint32_t y = 0; y < height; ++y)
    for (uint32_t x = 0; x < width; ++x)
      if (std::hypot(x + 0.5 - width / 2.0, y + 0.5 - height / 2.0) > radius)
        frame.profile[size_t{y} * width + x] = 0;
}

} // namespace

std::vector<SkipCase> make_skip_cases(uint32_t width, uint32_t height, double d_px,
                                      std::span<const CaptureProfile> profiles) {
  CapturedFrame plane = plane_frame(width, height, d_px, profiles);
  CapturedFrame flat = plane; // light 1 everywhere
  paint_noise(plane);
  CapturedFrame nothing = plane, far = plane_frame(width, height, subpixel_d_px, profiles),
                disc = plane;
  std::fill(nothing.profile.begin(), nothing.profile.end(), uint8_t{0});
  paint_noise(far);
  cut_disc(disc, covered);
  return {
      {"full", plane, false, false, false, ""},
      {"full_with_skips", plane, false, false, true, "full"},
      {"nothing_unskipped", nothing, false, false, false, ""},
      {"no_material", nothing, true, false, true, "nothing_unskipped"},
      {"no_bounds", nothing, false, true, true, "nothing_unskipped"},
      {"nothing_on_screen", nothing, false, false, true, "nothing_unskipped"},
      {"subpixel", far, false, false, true, ""},
      {"coverage_5_unskipped", disc, false, false, false, ""},
      {"coverage_5", disc, false, false, true, "coverage_5_unskipped"},
      {"flat_light_unskipped", flat, false, false, false, ""},
      {"flat_light", flat, false, false, true, "flat_light_unskipped"},
  };
}

} // namespace dermis::tools
