// Images of the scenes for reports.

#include "integration/tools/command/bench/subject.hpp"
#include "integration/tools/files/metrics.hpp"

#include <fmt/format.h>

namespace dermis::tools {
namespace {

constexpr uint32_t max_width = 480; // pixels

// Averages square cells of pixels to reduce the image's size.
ReportPicture picture_of(const Subject& subject) {
  const Image& light = subject.frame.lighting;
  ExposureMeter meter;
  meter.add(light.values, subject.frame.profile);
  const double exposure = meter.result();
  const uint32_t side = (light.width + max_width - 1) / max_width;
  demo::FloatImage small{light.width / side, light.height / side, 3, {}};
  for (uint32_t y = 0; y < small.height; ++y)
    for (uint32_t x = 0; x < small.width; ++x)
      for (uint32_t c = 0; c < 3; ++c) {
        double sum = 0;
        for (uint32_t j = 0; j < side; ++j)
          for (uint32_t i = 0; i < side; ++i)
            sum += double(light.at(x * side + i, y * side + j, c));
        small.texels.push_back(static_cast<float>(sum * exposure / (side * side)));
      }
  return {fmt::format("{} {}, d = {:.2f} px", subject.scene, subject.framing, subject.d_px),
          small.width, small.height, demo::tonemap(small)};
}

} // namespace

ReportPictures scene_pictures(std::span<const Subject> subjects) {
  ReportPictures group{
      "Scenes", "Light before scattering and before albedo, exposed and tonemapped.", {}};
  for (const Subject& subject : subjects)
    if (subject.frame.lighting.width > 0 && subject.frame.lighting.height > 0)
      group.pictures.push_back(picture_of(subject));
  return group;
}

} // namespace dermis::tools
