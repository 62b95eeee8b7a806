#pragma once
// Small orthographic captures, as made by hand.

#include "integration/tools/files/image.hpp"

#include <filesystem>
#include <string>

namespace dermis::test {

struct Plane {
  uint32_t width = 32, height = 32;
  double pixel_pitch_m = 1e-3;
  std::string profiles = R"([{ "id": 1, "dmfp_mm": [4, 4, 4], "albedo": [1, 1, 1] }])";
  tools::Image light;   // Empty: 0.5 everywhere.
  tools::Image profile; // Empty: 1 everywhere.
};

// Writes frame.json, lighting, depth and profile of a plane one metre away into `folder`.
void write_plane(const std::filesystem::path& folder, const Plane& plane = {});

// Replaces one image of the frame.
void write_channel(const std::filesystem::path& folder, const std::string& name,
                   const tools::Image& image);
tools::Image filled(uint32_t width, uint32_t height, uint32_t channels, float value);

} // namespace dermis::test
