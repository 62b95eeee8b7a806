// Tests render: pictures, numbers, and the messages for wrong scenes, models, graphs and folders.

#include "tests/integration/tools/command_fixture.hpp"
#include "tests/support/shipped_graphs.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace dermis::test {
namespace {

constexpr const char* bust = "configs/scenes/bust.json";

class Render : public CommandTest {
protected:
  Outcome render(const std::string& scene, const std::string& graph,
                 const std::vector<std::string>& more = {}, const RunOptions& options = {}) const {
    std::vector<std::string> words{"render", scene, "--graph", graph, "--out", path("out")};
    if (std::find(more.begin(), more.end(), "--size") == more.end())
      words.insert(words.end(), {"--size", "64x36"});
    words.insert(words.end(), more.begin(), more.end());
    return run(words, options);
  }
};

TEST_F(Render, WritesPicturesTimesAndErrors) {
  const Outcome outcome = render(bust, burley, {"--frames", "2", "--subset", "64"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(files("out"),
              ElementsAre("color_0000.exr", "color_0001.exr", "frame_0000.png", "frame_0001.png",
                          "scattered_0000.exr", "scattered_0001.exr"));
  EXPECT_THAT(outcome.out, HasAll("scatter", " ms", "PSNR", " dB", "RMSE", path("out")));
  EXPECT_THAT(outcome.out, ::testing::ContainsRegex("\ndevice: [^\n]+\n$"));
}

TEST_F(Render, BudgetWithoutAChoice_IsRejected) {
  EXPECT_THAT(render(bust, burley, {"--frames", "1", "--budget", "5"}),
              FailsWith(2, "--budget changes nothing in 'configs/graphs/burley.json'"));
  EXPECT_THAT(run({"explain", burley, "--frame", "--budget", "5", "--size", "16x16"}),
              FailsWith(2, "--budget changes nothing in 'configs/graphs/burley.json'"));
  EXPECT_THAT(files(), IsEmpty());
}

TEST_F(Render, PicturesOfTheLastFrame_TimesOfAll) {
  const std::vector<std::string> last{"--frames", "4", "--subset", "64", "--pictures", "last"};
  EXPECT_THAT(render(bust, burley, last),
              Succeeds("median of 3", "PSNR", "the last of 4 frames is in "));
  EXPECT_THAT(files("out"), ElementsAre("color_0003.exr", "frame_0003.png", "scattered_0003.exr"));
  EXPECT_THAT(render(bust, burley, {"--pictures", "last", "--capture", path("capture")}),
              FailsWith(2, "--capture", "all frames"));
}

TEST_F(Render, UnboundSlots) {
  EXPECT_THAT(render(bust, burley, {"--frames", "1", "--unbound", "scattered_light,albedo"}),
              Succeeds("does not export 'scattered_light'"));
  EXPECT_THAT(files("out"), ElementsAre("color_0000.exr", "frame_0000.png"));
  EXPECT_THAT(render(bust, burley, {"--unbound", "depth"}), FailsWith(2, "needs 'depth'"));
  EXPECT_THAT(render(bust, burley, {"--unbound", "depht"}),
              FailsWith(2, "no slot 'depht'", "depth, "));
  EXPECT_THAT(render(bust, "none", {"--unbound", "depth"}),
              FailsWith(2, "--unbound", "need a graph"));
}

// Without the slot the graph writes irradiance, and the engine multiplies it by albedo.
TEST_F(Render, UnboundAlbedo_IsAppliedByTheEngine) {
  const std::vector<std::string> off{"--frames", "1", "--set", "technique=\"off\""};
  EXPECT_THAT(render(bust, "configs/graphs/skin.json", off), Succeeds());
  std::filesystem::rename(path("out"), path("bound"));
  std::vector<std::string> unbound = off;
  unbound.insert(unbound.end(), {"--unbound", "albedo"});
  EXPECT_THAT(render(bust, "configs/graphs/skin.json", unbound), Succeeds());
  EXPECT_THAT(run({"compare", path("out/color_0000.exr"), path("bound/color_0000.exr"),
                   "--min-psnr", "60"}),
              Succeeds());
}

TEST_F(Render, GraphOnStandardInput) {
  RunOptions options;
  options.input = read_text(burley);
  EXPECT_THAT(render(bust, "-", {"--frames", "1", "--subset", "64"}, options), Succeeds("PSNR"));
  EXPECT_THAT(run({"explain", "-", "--frame", "--size", "64x36"}, options), Succeeds());
}

TEST_F(Render, SettingsMayBeWrittenAsForExplain) {
  EXPECT_THAT(run({"explain", burley, "--set", "samples=008"}), Succeeds());
  EXPECT_THAT(render(bust, burley, {"--frames", "1", "--subset", "0", "--set", "samples=008"}),
              Succeeds());
}

TEST_F(Render, JsonOutputIsOneDocument) {
  const Outcome outcome = render(bust, burley, {"--frames", "2", "--subset", "64", "--json"});
  ASSERT_THAT(outcome, Succeeds(IsJson(), "\"psnr_db\"", "\"rmse\"", "\"device_ms\""));
  EXPECT_THAT(outcome.err, IsEmpty());
}

// Without the pixels' shape in the graph the error is 2.4 times that of square pixels.
TEST_F(Render, WidePixels_ScatterAsWellAsSquareOnes) {
  std::string close = read_text(bust);
  const auto replace = [&](const std::string& old, const std::string& by) {
    for (size_t at = 0; (at = close.find(old, at)) != std::string::npos; at += by.size())
      close.replace(at, old.size(), by);
  };
  replace("../profiles", DERMIS_SOURCE_DIR "/configs/profiles");
  replace("[0.03, 0.0, 1.05], \"target\": [0.008, -0.027, 0.0], \"vertical_fov\": 16",
          "[-0.12, 0.03, 0.50], \"target\": [0, 0.005, 0.07], \"vertical_fov\": 10");
  std::string wide = close;
  const std::string camera = "\"camera\": {";
  wide.insert(wide.find(camera) + camera.size(), " \"pixel_aspect\": 2,");
  const auto rmse = [&](const std::string& scene, const std::vector<std::string>& size) {
    std::vector<std::string> more{"--frames", "1",      "--subset",       "512",
                                  "--json",   "--root", DERMIS_SOURCE_DIR};
    more.insert(more.end(), size.begin(), size.end());
    const Outcome outcome = render(write("scene.json", scene), "configs/graphs/sap.json", more);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    const size_t at = outcome.out.find("\"rmse\":");
    return at == std::string::npos ? NAN : std::stod(outcome.out.substr(at + 7));
  };
  const double square = rmse(close, {"--size", "144x96"});
  EXPECT_LE(rmse(close, {"--size", "72x96", "--pixel-aspect", "2"}), 1.5 * square);
  EXPECT_LE(rmse(wide, {"--size", "72x96"}), 1.5 * square);
}

TEST_F(Render, NoValidationMessages) {
  RunOptions options;
  options.environment = validation_environment();
  const Outcome outcome =
      render(bust, burley, {"--frames", "3", "--subset", "0", "--json"}, options);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  // A message of the layer would appear in the output.
  EXPECT_TRUE(is_json(outcome.out)) << outcome.out;
}

TEST_F(Render, DebugPicturesShowSkippedTiles) {
  for (const char* graph : {burley, "configs/graphs/skin.json"}) {
    ASSERT_THAT(render(bust, graph, {"--frames", "1", "--subset", "0", "--debug", "tile_class"}),
                Succeeds());
    EXPECT_THAT(files("out"), Contains("debug_0000.png")) << graph;
  }
}

TEST_F(Render, DebugSamples_NotExported_IsRejected) {
  EXPECT_THAT(render(bust, burley, {"--frames", "1", "--debug", "samples"}),
              FailsWith(2, "afis_guided.json, sap_blend.json and sap_residual.json do"));
  for (const char* graph : {"afis_guided", "sap_blend", "sap_residual"}) {
    EXPECT_THAT(render(bust, dermis::shipped::graph_file(graph),
                       {"--frames", "1", "--subset", "0", "--debug", "samples"}),
                Succeeds());
    EXPECT_THAT(files("out"), Contains("debug_0000.png")) << graph;
    std::filesystem::remove_all(path("out"));
  }
}

TEST_F(Render, SkipOverlayIsAppliedOnce) {
  EXPECT_THAT(render(bust, burley,
                     {"--frames", "1", "--subset", "0", "--debug", "tile_class", "--overlay",
                      "configs/overlays/debug_tile_class.json"}),
              Succeeds());
}

TEST_F(Render, SingleFrame_NoExpectedErrorWithoutBudget) {
  ASSERT_THAT(render(bust, burley, {"--frames", "1", "--subset", "0"}),
              Succeeds("(first frame, cold)", "\n1 frame is in ", Not(HasSubstr("expected"))));
}

TEST_F(Render, UnknownDebugPicture_IsAUsageError) {
  EXPECT_THAT(render(bust, burley, {"--debug", "colours"}), FailsWith(2, "--debug", "tile_class"));
  EXPECT_THAT(files("out"), IsEmpty());
}

TEST_F(Render, CapturedInputsCanBeAppliedAgain) {
  ASSERT_THAT(
      render(bust, burley, {"--frames", "2", "--subset", "0", "--capture", path("capture")}),
      Succeeds());
  EXPECT_THAT(
      run({"apply", "--graph", burley, "--frames", path("capture"), "--out", path("again")}),
      Succeeds());
  EXPECT_THAT(files("again"), Contains(HasSubstr("scattered.exr")));
}

TEST_F(Render, NoGraph_ShowsTheEnginesPicture) {
  const Outcome outcome = render(bust, "none", {"--frames", "1"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(files("out"), ElementsAre("color_0000.exr", "frame_0000.png"));
  EXPECT_THAT(outcome.out, HasSubstr("rendered without a graph"));
  EXPECT_EQ(render(bust, "none", {"--set", "samples=8"}).exit_code, 2);
}

TEST_F(Render, MissingScene_IsNamed) {
  EXPECT_THAT(render("configs/scenes/none.json", burley), FailsWith(1, "configs/scenes/none.json"));
  EXPECT_THAT(files(), IsEmpty());
}

TEST_F(Render, GraphWithErrors_WritesNothing) {
  const std::string bad = write("bad.json", "{ \"dermis\": 2, \"name\": \"x\" ");
  EXPECT_THAT(render(bust, bad), FailsWith(1, bad + ":1:"));
  EXPECT_THAT(files("out"), IsEmpty());
}

TEST_F(Render, ImportLargerThanTheView_IsNamed) {
  const std::string depth = "\"depth\": { \"format\": \"depth\",";
  const std::string graph =
      write("graph.json", replaced(read_text(std::string(DERMIS_SOURCE_DIR "/") + burley), depth,
                                   depth + " \"border\": 4,"));
  EXPECT_THAT(render(bust, graph),
              FailsWith(1, "needs 'depth' with 72x44 pixels", "images of the view's size, 64x36"));
}

TEST_F(Render, ErrorsOfTheLibrary_AreDiagnosticsInJson) {
  const std::string depth = "\"depth\": { \"format\": \"depth\",";
  const std::string graph =
      write("graph.json", replaced(read_text(std::string(DERMIS_SOURCE_DIR "/") + burley), depth,
                                   depth + " \"optional\": true,"));
  const Outcome outcome = render(bust, graph, {"--unbound", "depth", "--json"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_TRUE(is_json(outcome.out)) << outcome.out;
  EXPECT_THAT(outcome.out, HasAll("\"id\": \"D0311\"", "\"error\": \""));
}

TEST_F(Render, ModelThatIsNotGltf_IsNamed) {
  const std::string model = write("model.glb", "this is not a model");
  EXPECT_THAT(render("configs/scenes/head.json", burley, {"--model", model}),
              FailsWith(1, "model.glb"));
  EXPECT_THAT(files("out"), IsEmpty());
}

TEST_F(Render, UnwritableFolder_IsAnEnvironmentError) {
  const std::string file = write("file", "");
  EXPECT_THAT(run({"render", bust, "--graph", burley, "--size", "64x36", "--frames", "1", "--out",
                   file + "/out"}),
              FailsWith(3, "output folder", file + "/out"));
}

TEST_F(Render, NoVulkanDriver_IsAnEnvironmentError) {
  RunOptions options;
  options.environment = {"VK_ICD_FILENAMES=/nonexistent.json", "VK_DRIVER_FILES=/nonexistent.json"};
  EXPECT_THAT(render(bust, burley, {}, options), FailsWith(3, "Vulkan"));
  EXPECT_THAT(files(), IsEmpty());
}

TEST_F(Render, CtrlC_StopsAtTheNextFrameWithCompleteFiles) {
  RunOptions options;
  options.interrupt_after = path("out/frame_0000.png");
  EXPECT_THAT(render(bust, burley, {"--frames", "10000"}, options), FailsWith(130, "stopped"));
  const std::vector<std::string> left = files("out");
  EXPECT_THAT(left,
              Each(::testing::AnyOf(::testing::EndsWith(".png"), ::testing::EndsWith(".exr"))));
  EXPECT_THAT(left, Not(Contains("frame_9999.png")));
}

} // namespace
} // namespace dermis::test
