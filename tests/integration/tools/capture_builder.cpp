#include "tests/integration/tools/capture_builder.hpp"

#include "integration/tools/files/exr.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>

namespace dermis::test {

tools::Image filled(uint32_t width, uint32_t height, uint32_t channels, float value) {
  tools::Image image = tools::Image::sized(width, height, channels);
  std::fill(image.values.begin(), image.values.end(), value);
  return image;
}

void write_channel(const std::filesystem::path& folder, const std::string& name,
                   const tools::Image& image) {
  const tools::ChannelNames rgb = {"R", "G", "B"}, single = {"Y"};
  std::string problem;
  EXPECT_TRUE(tools::write_exr(folder / (name + ".exr"), image, image.channels == 3 ? rgb : single,
                               problem))
      << problem;
}

void write_plane(const std::filesystem::path& folder, const Plane& plane) {
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "frame.json")
      << fmt::format("{{ \"dermis_capture\": 1, \"width\": {0}, \"height\": {1}, "
                     "\"render_rectangle\": [0, 0, {0}, {1}],\n"
                     "  \"projection\": \"orthographic\", \"pixel_pitch_m\": {2}, "
                     "\"metres_per_unit\": 1, \"jitter_px\": "
                     "[0, 0],\n"
                     "  \"frame_index\": 1, \"exposure\": 1, \"profiles\": {3} }}\n",
                     plane.width, plane.height, plane.pixel_pitch_m, plane.profiles);
  const auto given = [&](const tools::Image& image, uint32_t channels, float otherwise) {
    return image.values.empty() ? filled(plane.width, plane.height, channels, otherwise) : image;
  };
  write_channel(folder, "lighting", given(plane.light, 3, 0.5f));
  write_channel(folder, "depth", filled(plane.width, plane.height, 1, 1.0f));
  write_channel(folder, "profile", given(plane.profile, 1, 1.0f));
}

} // namespace dermis::test
