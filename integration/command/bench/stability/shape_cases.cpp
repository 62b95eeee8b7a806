// Distances, slopes, sizes and radii at their limits.
#include "integration/command/bench/stability/cases.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dermis::tools {
namespace {

StabilityCase furnace_of(std::string_view name, std::function<CapturedFrame()> make, double bound = furnace) {
  StabilityCase made;
  made.name = name;
  made.given = [make = std::move(make)](uint32_t) { return make(); };
  made.wanted = [](uint32_t) { return 1.0; };
  made.bound = bound;
  return made;
}

// A plane that turns away by `degrees` about the vertical axis.
StabilityCase grazing(std::string_view name, double degrees) {
  return furnace_of(name, [degrees] {
    CapturedFrame frame = sound_frame();
    const double slope = std::tan(degrees * 3.14159265358979323846 / 180) * *frame.description.pixel_pitch_m;
    for (uint32_t y = 0; y < stability_side; ++y)
      for (uint32_t x = 0; x < stability_side; ++x)
        frame.depth.at(x, y, 0) = static_cast<float>(1 + slope * x);
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

// A factor on d that leaves nothing to scatter: the light stays as it is, bit for bit.
StabilityCase without_scattering(std::string_view name, float scale) {
  StabilityCase made;
  made.name = name;
  made.given = [scale](uint32_t) { return with_scale(textured_frame(), scale); };
  made.same_as = [](uint32_t) { return with_scale(textured_frame(), 0.0f); };
  return made;
}

// The right half has a depth that is none; the left one goes on as if there were nothing.
StabilityCase odd_depth(std::string_view name, float depth) {
  const auto with = [depth](bool damaged) {
    return [depth, damaged](uint32_t) {
      CapturedFrame frame = sound_frame();
      for (uint32_t y = 0; y < stability_side; ++y)
        for (uint32_t x = stability_side / 2; x < stability_side; ++x) {
          frame.depth.at(x, y, 0) = damaged ? depth : 0.0f;
          frame.profile[y * stability_side + x] = damaged ? 1 : 0;
        }
      return frame;
    };
  };
  StabilityCase made;
  made.name = name;
  made.given = with(true);
  made.same_as = with(false);
  made.bound = furnace;
  return made;
}

StabilityCase far_plane(std::string_view name, float metres) {
  return furnace_of(name, [metres] {
    CapturedFrame frame = sound_frame();
    std::fill(frame.depth.values.begin(), frame.depth.values.end(), metres);
    return frame;
  });
}

} // namespace

std::vector<StabilityCase> shape_cases() {
  StabilityCase no_number = without_scattering("scatter_scale_nan", not_a_number);
  StabilityCase endless =
      furnace_of("scatter_scale_infinity", [] { return with_scale(sound_frame(), infinity); });
  StabilityCase widest = sized("size_16384x64", 16384, 64);
  widest.may_be_refused = true; // where images have a border, the last columns have no room on the device
  StabilityCase all_sky;
  all_sky.name = "nothing_but_sky";
  all_sky.given = [](uint32_t) {
    CapturedFrame frame = sound_frame();
    std::fill(frame.depth.values.begin(), frame.depth.values.end(), 0.0f);
    return frame;
  };
  all_sky.finite_only = true;
  return {grazing("grazing_85", 85),
          grazing("grazing_89", 89),
          grazing("grazing_89_9", 89.9),
          odd_depth("depth_zero_beside", 0),
          odd_depth("depth_nan_beside", not_a_number),
          odd_depth("depth_infinity_beside", infinity),
          odd_depth("depth_negative_beside", -1),
          far_plane("depth_1e-6_m", 1e-6f),
          far_plane("depth_1e6_m", 1e6f),
          all_sky,
          sized("size_1x1", 1, 1),
          sized("size_1x7", 1, 7),
          sized("size_131x3", 131, 3),
          widest,
          without_scattering("d_1e-30", 1e-30f),
          without_scattering("d_1e-6", 1e-6f),
          without_scattering("scatter_scale_negative", -1),
          no_number,
          endless,
          furnace_of("d_1e4_px",
                     [] { return with_scale(sound_frame(), static_cast<float>(1e4 / stability_d_px)); })};
}

} // namespace dermis::tools
