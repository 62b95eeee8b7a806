#include "tests/integration/examples/demo_engine/rendering.hpp"
#include "tests/support/shipped_graphs.hpp"
#include "tests/support/test_folder.hpp"
#include "tests/support/text_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace demo {
namespace {

using testing::HasSubstr;

const std::string shipped = DERMIS_SOURCE_DIR "/configs/";

// Returns the size of anonymous executable mappings.
uint64_t generated_code_bytes() {
  std::ifstream maps("/proc/self/maps");
  uint64_t bytes = 0;
  for (std::string line; std::getline(maps, line);) {
    std::istringstream fields(line);
    uint64_t begin = 0, end = 0;
    char dash = 0;
    std::string access, offset, device, inode;
    fields >> std::hex >> begin >> dash >> end >> access >> offset >> device >> inode;
    if (access.size() == 4 && access[2] == 'x' && inode == "0" &&
        line.find('[') == std::string::npos)
      bytes += end - begin;
  }
  return bytes;
}

// Renders a ball in front of a wall from `camera`, in a temporary folder.
struct Engine : ::testing::Test {
  RenderOptions small(const std::string& camera =
                          R"({ "position": [0, 0, 1], "target": [0, 0, 0], "vertical_fov": 20 })",
                      const std::string& profile_file = shipped + "profiles/skin.json") const {
    const std::string path = (folder / "scene.json").string();
    std::ofstream(path) << R"({ "dermis_scene": 1, "name": "small", "sky": [0.1, 0.1, 0.1],
      "profiles": [ { "name": "skin", "file": ")"
                        << profile_file << R"(" } ], "camera": )" << camera << R"(,
      "lights": [ { "type": "spot", "position": [-0.5, 0.5, 0.8], "target": [0, 0, 0], "intensity": 0.8 },
                  { "type": "directional", "position": [1, 1, 1], "target": [0, 0, 0], "intensity": 0.2 },
                  { "type": "point", "position": [0.3, 0.1, 0.3], "intensity": 0.02 } ],
      "objects": [ { "shape": "sphere", "scale": [0.1, 0.1, 0.1], "profile": "skin", "pattern": "skin",
                     "albedo": [0.7, 0.45, 0.35] },
                   { "shape": "plane", "position": [0, 0, -0.3], "rotation": [90, 0, 0] } ] })";
    RenderOptions options;
    options.scene = path;
    options.roots = {shipped};
    options.width = 70; // Not a multiple of the tile side.
    options.height = 45;
    options.validation = true;
    return options;
  }

  static std::vector<FrameOutputs> frames_of(const RenderOptions& options) {
    return rendered(options).frames;
  }
  static void expect_rejected(const RenderOptions& options, ErrorKind kind,
                              const std::string& text) {
    const auto summary = render(options, {});
    ASSERT_FALSE(summary) << "it was rendered";
    EXPECT_EQ(summary.error().kind, kind);
    EXPECT_THAT(summary.error().text, HasSubstr(text));
  }

  const dermis::test::TestFolder folder;
};

size_t center_of(const FloatImage& image) {
  return (size_t{image.height} / 2 * image.width + image.width / 2) * image.channels;
}

TEST_F(Engine, ExportsTheGraphsInputs) {
  const auto frames = frames_of(small());
  ASSERT_EQ(frames.size(), 1u);
  const GraphInputs& in = frames[0].inputs;
  const size_t pixel = center_of(in.depth);
  // The ball of radius 0.1 m is 1 m in front of the camera; its middle pixel is off the axis by
  // half a pixel.
  EXPECT_NEAR(in.depth.texels[pixel], 0.9f, 1e-3f);
  EXPECT_EQ(in.profile.texels[pixel], 1.0f);
  EXPECT_NEAR(in.normal.texels[3 * pixel + 2], 1.0f, 1e-2f);
  EXPECT_NEAR(in.depth.texels[0], 1.3f, 1e-3f); // The wall.
  EXPECT_EQ(in.profile.texels[0], 0.0f);
  for (const float value : in.lighting.texels)
    ASSERT_TRUE(std::isfinite(value) && value >= 0.0f);
  for (const float value : in.velocity.texels) // drivers round positions differently
    ASSERT_NEAR(value, 0.0f, 1e-5f);
  EXPECT_EQ(frames[0].display.size(), 70u * 45u * 3u);
  EXPECT_TRUE(frames[0].scattered.texels.empty());
}

TEST_F(Engine, ReversedDepthShowsTheSameScene) {
  RenderOptions options = small();
  const auto forward = frames_of(options);
  options.reversed_depth = true;
  const auto reversed = frames_of(options);
  ASSERT_EQ(forward.size() + reversed.size(), 2u);
  const FloatImage &a = forward[0].inputs.depth, &b = reversed[0].inputs.depth;
  size_t different = 0;
  for (size_t i = 0; i < a.texels.size(); ++i)
    // fp32 depth near 1: a step of 6e-8 becomes z^2 / near times that, 2e-6 m at 1.3 m; ten of them
    // for the arithmetic.
    if (std::abs(a.texels[i] - b.texels[i]) > 2e-5f) ++different;
  EXPECT_LE(different, 3u); // A pixel centre on an edge may fall to either side.
}

TEST_F(Engine, OrthographicPan_MovesPixelsByItsLength) {
  RenderOptions options = small(R"({ "projection": "orthographic", "height": 0.45, "target":
      { "keys": [[0, 0, 0, 0], [1, 0.25, 0.125, 0]] },
      "position": { "keys": [[0, 0, 0, 1], [1, 0.25, 0.125, 1]] } })");
  options.first_frame = 3;
  const auto frames = frames_of(options);
  ASSERT_EQ(frames.size(), 1u);
  EXPECT_TRUE(frames[0].camera.orthographic);
  // 0.01 m right and 0.005 m up per frame at 0.01 m per pixel: objects move 1 pixel left and half a
  // pixel down.
  const FloatImage& velocity = frames[0].inputs.velocity;
  for (size_t i = 0; i < velocity.texels.size(); i += 2) {
    // binary16 near 1, and fp32 differences of clip positions.
    ASSERT_NEAR(velocity.texels[i], -1.0f, 2e-3f);
    ASSERT_NEAR(velocity.texels[i + 1], 0.5f, 2e-3f);
  }
}

TEST_F(Engine, JitterDoesNotChangeVelocity) {
  RenderOptions options = small();
  options.jitter = true;
  options.frames = 2;
  const auto frames = frames_of(options);
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_NE(frames[0].camera.jitter_pixels, frames[1].camera.jitter_pixels);
  for (const float value : frames[1].inputs.velocity.texels)
    ASSERT_NEAR(value, 0.0f, 1e-5f);
}

TEST_F(Engine, EveryShippedGraphRunsAndConservesLight) {
  for (const char* graph : {"burley", "separable"}) {
    RenderOptions options = small();
    options.graph = shipped + "graphs/" + graph + ".json";
    options.frames = 3;
    const auto frames = frames_of(options);
    ASSERT_EQ(frames.size(), 3u) << graph;
    const FrameOutputs& frame = frames[2];
    ASSERT_EQ(frame.scattered.texels.size(), frame.inputs.lighting.texels.size()) << graph;
    double before = 0.0, after = 0.0;
    for (size_t i = 0; i < frame.inputs.profile.texels.size(); ++i) {
      if (frame.inputs.profile.texels[i] == 0.0f) continue;
      before += frame.inputs.lighting.texels[3 * i];
      after += frame.scattered.texels[3 * i];
    }
    // Scattering moves light; area weights near the silhouette change the pixel sum a little.
    EXPECT_NEAR(after / before, 1.0, 0.1) << graph;
    EXPECT_FALSE(frame.dermis_times.empty()) << graph;
  }
}

TEST_F(Engine, GraphsOnlyChangePixelsThatScatter) {
  RenderOptions options = small();
  const auto plain = frames_of(options);
  options.graph = shipped + "graphs/burley.json";
  const auto scattered = frames_of(options);
  ASSERT_EQ(plain.size() + scattered.size(), 2u);
  size_t changed = 0;
  for (size_t i = 0; i < plain[0].inputs.profile.texels.size(); ++i) {
    for (size_t c = 0; c < 3; ++c) {
      const float a = plain[0].color.texels[3 * i + c], b = scattered[0].color.texels[3 * i + c];
      if (plain[0].inputs.profile.texels[i] == 0.0f) {
        ASSERT_EQ(a, b);
      } else if (a != b) {
        ++changed;
      }
    }
  }
  EXPECT_GT(changed, 300u);
}

TEST_F(Engine, ErrorsHaveTheRightKindAndNameTheirSubject) {
  RenderOptions options = small();
  options.width = 0;
  expect_rejected(options, ErrorKind::usage, "0x45");
  options = small();
  options.frames = 0;
  expect_rejected(options, ErrorKind::usage, "");
  options = small();
  options.scene = "no/such/scene.json";
  expect_rejected(options, ErrorKind::input, "no/such/scene.json");
  options = small();
  options.graph = "no/such/graph.json";
  expect_rejected(options, ErrorKind::input, "no/such/graph.json");
  options = small(R"({ "position": [0, 0, 1], "target": [0, 0, 0], "vertical_fov": 20 })",
                  "no/such/profile.json");
  options.graph = shipped + "graphs/burley.json";
  expect_rejected(options, ErrorKind::input, "no/such/profile.json");
  options = small();
  options.scene = shipped + "scenes/head.json";
  expect_rejected(options, ErrorKind::usage, "--model");
}

TEST_F(Engine, GraphWithUnsupportedInput_IsNamed) {
  const std::string path = (folder / "graph.json").string();
  std::ofstream(path) << dermis::test::replaced(
      dermis::test::read_text(shipped + "graphs/burley.json"),
      R"("size": "view", "optional": true, "note": "factor on the scattering)",
      R"("size": "view", "note": "factor on the scattering)");
  RenderOptions options = small();
  options.graph = path;
  expect_rejected(options, ErrorKind::input, "scatter_scale");
}

// Mesa's software driver recompiles a kernel at each bind if a branch depends only on uniform
// values, and keeps the code. Later frames would pay for it in time and memory.
TEST_F(Engine, KernelsAreCompiledInTheFirstFrames) {
  for (const char* graph : {"afis_guided", "hybrid", "sap_blend", "sap_residual", "skin"}) {
    SCOPED_TRACE(graph);
    RenderOptions options = small();
    options.graph = DERMIS_SOURCE_DIR "/" + dermis::shipped::graph_file(graph);
    options.frames = 8;
    options.validation = false;
    std::vector<uint64_t> code_bytes;
    bool software = true;
    RenderCallbacks callbacks;
    callbacks.on_start = [&](const RenderInfo& info) {
      software = info.device.starts_with("llvmpipe");
      return success();
    };
    callbacks.on_frame = [&](const FrameOutputs&) {
      code_bytes.push_back(generated_code_bytes());
      return success();
    };
    ASSERT_TRUE(render(options, callbacks));
    if (!software) GTEST_SKIP() << "the device is not Mesa's software driver";
    ASSERT_EQ(code_bytes.size(), 8u);
    EXPECT_GT(code_bytes[3], 0u);
    EXPECT_EQ(code_bytes[7], code_bytes[3]) << ::testing::PrintToString(code_bytes);
  }
}

TEST_F(Engine, FramesWithoutPicturesRunToo) {
  RenderOptions options = small();
  options.graph = shipped + "graphs/skin.json";
  options.frames = 3;
  const auto all = frames_of(options);
  options.pictures_of = [](uint32_t frame) { return frame == 2; };
  const auto last = frames_of(options);
  ASSERT_EQ(last.size(), 3u);
  ASSERT_EQ(all.size(), 3u);
  for (size_t i = 0; i < 2; ++i) {
    EXPECT_TRUE(last[i].inputs.lighting.texels.empty());
    EXPECT_TRUE(last[i].scattered.texels.empty());
    EXPECT_TRUE(last[i].color.texels.empty());
    EXPECT_EQ(last[i].choice->configuration, all[i].choice->configuration);
    EXPECT_EQ(last[i].dermis_times.size(), all[i].dermis_times.size());
  }
  EXPECT_EQ(last[2].inputs.lighting.texels, all[2].inputs.lighting.texels);
  EXPECT_EQ(last[2].scattered.texels, all[2].scattered.texels);
  EXPECT_EQ(last[2].color.texels, all[2].color.texels);
}

TEST_F(Engine, GraphSettingIsSetByName) {
  RenderOptions options = small();
  options.graph = shipped + "graphs/burley.json";
  options.settings = {{"samples", "8"}};
  EXPECT_EQ(frames_of(options).size(), 1u);
  // The first has another name, the second is not a number.
  for (const char* name : {"sample", "samples"}) {
    options.settings = {{name, "\"many\""}};
    expect_rejected(options, ErrorKind::usage, name);
  }
}

TEST_F(Engine, ErrorOfTheCallback_EndsTheRendering) {
  RenderOptions options = small();
  options.frames = 3;
  uint32_t seen = 0;
  RenderCallbacks callbacks;
  callbacks.on_frame = [&](const FrameOutputs&) -> Result<> {
    ++seen;
    return Error{ErrorKind::environment, "the disk is full"};
  };
  const auto summary = render(options, callbacks);
  ASSERT_FALSE(summary);
  EXPECT_EQ(summary.error().text, "the disk is full");
  EXPECT_EQ(seen, 1u);
}

TEST(Tonemap, IsMonotoneAndKeepsBlackAndWhite) {
  FloatImage ramp{256, 1, 1, {}};
  for (int i = 0; i < 256; ++i)
    ramp.texels.push_back(static_cast<float>(i) / 16.0f);
  const auto shown = tonemap(ramp);
  EXPECT_EQ(shown.front(), 0);
  EXPECT_GE(shown.back(), 250);
  EXPECT_TRUE(std::is_sorted(shown.begin(), shown.end()));
  const FloatImage broken{2, 1, 1, {std::nanf(""), -1.0f}};
  EXPECT_THAT(tonemap(broken), testing::ElementsAre(0, 0));
}

} // namespace
} // namespace demo
