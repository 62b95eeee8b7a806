// Tests the engine's temporal anti-aliasing: more accurate edges in static scenes, and no ghosts
// after a cut.
#include "integration/examples/demo_engine/engine.hpp"
#include "tests/support/test_folder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

namespace demo {
namespace {

struct TemporalAntiAliasing : ::testing::Test {
  // A bright ball in front of a dark wall. The camera moves from left to right within a second and
  // jumps at 0.5 s.
  RenderOptions options(const std::string& camera, uint32_t width, uint32_t height) const {
    const std::string path = (folder / "scene.json").string();
    std::ofstream(path)
        << R"({ "dermis_scene": 1, "name": "small", "sky": [0.1, 0.1, 0.1], "cuts": [0.5],
      "frames_per_second": 20, "camera": )"
        << camera << R"(,
      "lights": [ { "type": "directional", "position": [1, 1, 1], "target": [0, 0, 0], "intensity": 0.8 } ],
      "objects": [ { "shape": "sphere", "scale": [0.1, 0.1, 0.1], "albedo": [0.9, 0.8, 0.7] },
                   { "shape": "plane", "position": [0, 0, -0.3], "rotation": [90, 0, 0], "albedo": [0.1, 0.1, 0.1] } ] })";
    RenderOptions options;
    options.scene = path;
    options.width = width;
    options.height = height;
    options.validation = true;
    return options;
  }

  static std::vector<FloatImage> colors_of(const RenderOptions& options) {
    std::vector<FloatImage> colors;
    RenderCallbacks callbacks;
    callbacks.on_frame = [&](const FrameOutputs& frame) {
      colors.push_back(frame.color);
      return success();
    };
    const auto summary = render(options, callbacks);
    EXPECT_TRUE(summary) << summary.error().text;
    if (summary) {
      for (const std::string& message : summary->validation_messages)
        ADD_FAILURE() << message;
    }
    return colors;
  }

  const dermis::test::TestFolder folder;
};

const std::string resting_camera =
    R"({ "position": [0, 0, 1], "target": [0, 0, 0], "vertical_fov": 20 })";
const std::string going_camera =
    R"({ "position": { "keys": [[0, -0.1, 0, 1], [1, 0.1, 0, 1]] }, "target": [0, 0, 0], "vertical_fov": 20 })";

// Returns means of squares of `side` x `side` pixels.
FloatImage smaller(const FloatImage& large, uint32_t side) {
  FloatImage small{large.width / side, large.height / side, 3, {}};
  for (uint32_t y = 0; y < small.height; ++y)
    for (uint32_t x = 0; x < small.width; ++x)
      for (uint32_t c = 0; c < 3; ++c) {
        float sum = 0;
        for (uint32_t j = 0; j < side; ++j)
          for (uint32_t i = 0; i < side; ++i)
            sum += large.texels[3 * (size_t{y * side + j} * large.width + x * side + i) + c];
        small.texels.push_back(sum / static_cast<float>(side * side));
      }
  return small;
}

double rmse(const FloatImage& a, const FloatImage& b) {
  double sum = 0;
  for (size_t i = 0; i < a.texels.size(); ++i)
    sum += std::pow(double(a.texels[i]) - double(b.texels[i]), 2);
  return std::sqrt(sum / double(a.texels.size()));
}

TEST_F(TemporalAntiAliasing, StaticPicture_ApproachesSupersampling) {
  constexpr uint32_t width = 70, height = 45, side = 8;
  const FloatImage reference =
      smaller(colors_of(options(resting_camera, width * side, height * side)).front(), side);
  RenderOptions resting = options(resting_camera, width, height);
  const FloatImage single = colors_of(resting).front();
  resting.taa = true;
  resting.frames = 9; // Before the cut.
  resting.first_frame = 0;
  const FloatImage resolved = colors_of(resting).back();
  RecordProperty("single", std::to_string(rmse(single, reference)));
  RecordProperty("resolved", std::to_string(rmse(resolved, reference)));
  // Regression bound of the present implementation.
  EXPECT_LT(rmse(resolved, reference), 0.6 * rmse(single, reference));
}

TEST_F(TemporalAntiAliasing, FirstFrameAfterACut_HasNoGhosts) {
  RenderOptions going = options(going_camera, 70, 45);
  going.taa = true;
  going.first_frame = 6;
  going.frames = 5; // The cut is at frame 10.
  const std::vector<FloatImage> through = colors_of(going);
  going.first_frame = 10;
  going.frames = 1;
  const std::vector<FloatImage> still_frame = colors_of(going);
  ASSERT_EQ(through.size(), 5u);
  EXPECT_EQ(through[4].texels, still_frame[0].texels);
  going.first_frame = 9;
  EXPECT_NE(through[3].texels, colors_of(going)[0].texels);
}

} // namespace
} // namespace demo
