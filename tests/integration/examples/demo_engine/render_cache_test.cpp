// Frames of a kept cache equal frames that are rendered without one, bit for bit.
#include "tests/integration/examples/demo_engine/rendering.hpp"
#include "tests/support/shipped_graphs.hpp"
#include "tests/support/test_folder.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>

namespace demo {
namespace {

// A ball of skin in front of a wall, with a moving camera and shadow, and a cut within five frames.
struct KeptCache : ::testing::Test {
  RenderOptions moving(const std::string& graph, const std::string& intensity = "0.8") const {
    RenderOptions options;
    options.scene = (folder / ("scene_" + intensity + ".json")).string();
    std::ofstream(options.scene)
        << R"({ "dermis_scene": 1, "name": "small", "sky": [0.1, 0.1, 0.1], "cuts": [0.3],
      "frames_per_second": 10,
      "profiles": [ { "name": "skin", "file": ")" DERMIS_SOURCE_DIR
           R"(/configs/profiles/skin.json" } ],
      "camera": { "position": { "keys": [[0, -0.2, 0, 1], [1, 0.2, 0, 1]] }, "target": [0, 0, 0], "vertical_fov": 20 },
      "lights": [ { "type": "spot", "position": { "keys": [[0, -0.5, 0.5, 0.8], [1, 0.5, 0.5, 0.8]] },
                    "target": [0, 0, 0], "intensity": )"
        << intensity << R"( } ],
      "objects": [ { "shape": "sphere", "scale": [0.1, 0.1, 0.1], "profile": "skin", "albedo": [0.7, 0.45, 0.35] },
                   { "shape": "plane", "position": [0, 0, -0.3], "rotation": [90, 0, 0] } ] })";
    options.graph = DERMIS_SOURCE_DIR "/" + dermis::shipped::graph_file(graph);
    options.roots = {DERMIS_SOURCE_DIR "/configs"};
    options.width = 70;
    options.height = 45;
    options.frames = 5;
    options.validation = true;
    return options;
  }

  const dermis::test::TestFolder folder;
};

void expect_same(const std::vector<FrameOutputs>& a, const std::vector<FrameOutputs>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (size_t i = 0; i < a.size(); ++i) {
    const GraphInputs &x = a[i].inputs, &y = b[i].inputs;
    for (const auto& part :
         {&GraphInputs::lighting, &GraphInputs::depth, &GraphInputs::normal, &GraphInputs::albedo,
          &GraphInputs::profile, &GraphInputs::velocity, &GraphInputs::specular,
          &GraphInputs::thickness, &GraphInputs::back_lighting})
      EXPECT_EQ((x.*part).texels, (y.*part).texels) << "frame " << i;
    EXPECT_EQ(a[i].scattered.texels, b[i].scattered.texels) << "frame " << i;
    EXPECT_EQ(a[i].color.texels, b[i].color.texels) << "frame " << i;
    EXPECT_EQ(a[i].camera.previous_clip_from_view, b[i].camera.previous_clip_from_view)
        << "frame " << i;
    EXPECT_EQ(a[i].cut, b[i].cut) << "frame " << i;
  }
}

size_t rendered_frames(const std::vector<FrameOutputs>& frames) {
  return static_cast<size_t>(
      std::count_if(frames.begin(), frames.end(),
                    [](const FrameOutputs& frame) { return !frame.host_times.empty(); }));
}

TEST_F(KeptCache, ReproducesFramesBitForBit) {
  const RenderOptions options = moving("sap");
  const RenderCacheHandle cache = make_render_cache();
  const auto separate = rendered(options).frames;
  const auto first = rendered(options, cache.get()).frames;
  const auto second = rendered(options, cache.get()).frames;
  EXPECT_EQ(rendered_frames(separate), 5u);
  EXPECT_EQ(rendered_frames(first), 5u);
  EXPECT_EQ(rendered_frames(second), 0u);
  expect_same(separate, first);
  expect_same(separate, second);
}

TEST_F(KeptCache, OtherGraph_UsesTheKeptFrames) {
  const RenderCacheHandle cache = make_render_cache();
  ASSERT_EQ(rendered(moving("sap"), cache.get()).frames.size(), 5u);
  const RenderOptions options = moving("burley");
  expect_same(rendered(options).frames, rendered(options, cache.get()).frames);
}

TEST_F(KeptCache, OtherPictureOrScene_IsRebuilt) {
  const RenderCacheHandle cache = make_render_cache();
  RenderOptions options = moving("sap");
  ASSERT_EQ(rendered(options, cache.get()).frames.size(), 5u);
  options.width = 33;
  expect_same(rendered(options).frames, rendered(options, cache.get()).frames);
  options.scene = moving("sap", "0.4").scene;
  const auto frames = rendered(options, cache.get()).frames;
  EXPECT_EQ(rendered_frames(frames), 5u);
  expect_same(rendered(options).frames, frames);
}

TEST_F(KeptCache, AfterAnError_TheNextCallWorks) {
  const RenderCacheHandle cache = make_render_cache();
  RenderOptions options = moving("sap");
  options.scene = "no/such/scene.json";
  const auto rejected = render(options, {}, cache.get());
  ASSERT_FALSE(rejected);
  EXPECT_EQ(rejected.error().kind, ErrorKind::input);
  EXPECT_EQ(rendered(moving("sap"), cache.get()).frames.size(), 5u);
}

TEST_F(KeptCache, UnrequestedPicturesAreEmpty) {
  RenderOptions options = moving("sap");
  options.pictures_of = [](uint32_t frame) { return frame == 3; };
  options.inputs_of = [](uint32_t frame) { return frame == 1; };
  const auto frames = rendered(options).frames;
  const auto all = rendered(moving("sap")).frames;
  ASSERT_EQ(frames.size(), 5u);
  ASSERT_EQ(all.size(), 5u);
  for (uint32_t i = 0; i < 5; ++i) {
    EXPECT_EQ(frames[i].inputs.depth.texels.empty(), i != 1) << i;
    EXPECT_EQ(frames[i].scattered.texels.empty(), i != 3) << i;
    EXPECT_EQ(frames[i].color.texels.empty(), i != 3) << i;
  }
  EXPECT_EQ(frames[1].inputs.lighting.texels, all[1].inputs.lighting.texels);
  EXPECT_EQ(frames[3].color.texels, all[3].color.texels);
}

} // namespace
} // namespace demo
