// Tests render: pictures, numbers, and the messages for wrong scenes, models, graphs and folders.

#include "tests/integration/tools/command_fixture.hpp"
#include "tests/support/shipped_graphs.hpp"

#include <algorithm>

namespace dermis::test {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::Each;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr const char* bust = "configs/scenes/bust.json";

class Render : public CommandTest {
protected:
  Outcome render(const std::string& scene, const std::string& graph,
                 const std::vector<std::string>& more = {}, const RunOptions& options = {}) const {
    std::vector<std::string> words{"render", scene,       "--graph", graph,
                                   "--out",  path("out"), "--size",  "64x36"};
    words.insert(words.end(), more.begin(), more.end());
    return run(words, options);
  }
};

TEST_F(Render, WritesPicturesTimesAndErrors) {
  const Outcome outcome = render(bust, burley, {"--frames", "2", "--subset", "64"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(files("out"),
              ::testing::ElementsAre("color_0000.exr", "color_0001.exr", "frame_0000.png", "frame_0001.png",
                                     "scattered_0000.exr", "scattered_0001.exr"));
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("scatter"), HasSubstr(" ms"), HasSubstr("PSNR"), HasSubstr(" dB"),
                                 HasSubstr("RMSE"), HasSubstr(path("out"))));
}

TEST_F(Render, JsonOutputIsOneDocument) {
  const Outcome outcome = render(bust, burley, {"--frames", "2", "--subset", "64", "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_TRUE(is_json(outcome.out)) << outcome.out;
  EXPECT_THAT(outcome.out,
              AllOf(HasSubstr("\"psnr_db\""), HasSubstr("\"rmse\""), HasSubstr("\"device_ms\"")));
  EXPECT_THAT(outcome.err, IsEmpty());
}

TEST_F(Render, NoValidationMessages) {
  RunOptions options;
  options.environment = validation_environment();
  const Outcome outcome = render(bust, burley, {"--frames", "3", "--subset", "0", "--json"}, options);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  // A message of the layer would appear in the output.
  EXPECT_TRUE(is_json(outcome.out)) << outcome.out;
}

TEST_F(Render, DebugPicturesShowSkippedTiles) {
  for (const char* graph : {burley, "configs/graphs/skin.json"}) {
    const Outcome outcome = render(bust, graph, {"--frames", "1", "--subset", "0", "--debug", "tile_class"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(files("out"), Contains("debug_0000.png")) << graph;
  }
}

TEST_F(Render, DebugSamples_NotExported_IsRejected) {
  const Outcome outcome = render(bust, burley, {"--frames", "1", "--debug", "samples"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("afis_guided.json, sap_blend.json and sap_residual.json do"));
  for (const char* graph : {"afis_guided", "sap_blend", "sap_residual"}) {
    const Outcome rendered = render(bust, dermis::shipped::graph_file(graph),
                                    {"--frames", "1", "--subset", "0", "--debug", "samples"});
    EXPECT_EQ(rendered.exit_code, 0) << rendered.err;
    EXPECT_THAT(files("out"), Contains("debug_0000.png")) << graph;
    std::filesystem::remove_all(path("out"));
  }
}

TEST_F(Render, SkipOverlayIsAppliedOnce) {
  const Outcome outcome = render(bust, burley,
                                 {"--frames", "1", "--subset", "0", "--debug", "tile_class", "--overlay",
                                  "configs/overlays/debug_tile_class.json"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
}

TEST_F(Render, SingleFrame_NoExpectedErrorWithoutBudget) {
  const Outcome outcome = render(bust, burley, {"--frames", "1", "--subset", "0"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("(first frame, cold)"), HasSubstr("\n1 frame is in "),
                                 Not(HasSubstr("expected"))));
}

TEST_F(Render, UnknownDebugPicture_IsAUsageError) {
  const Outcome outcome = render(bust, burley, {"--debug", "colours"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("--debug"), HasSubstr("tile_class")));
  EXPECT_THAT(files("out"), IsEmpty());
}

TEST_F(Render, CapturedInputsCanBeAppliedAgain) {
  const Outcome captured =
      render(bust, burley, {"--frames", "2", "--subset", "0", "--capture", path("capture")});
  ASSERT_EQ(captured.exit_code, 0) << captured.err;
  const Outcome applied =
      run({"apply", "--graph", burley, "--frames", path("capture"), "--out", path("again")});
  EXPECT_EQ(applied.exit_code, 0) << applied.err;
  EXPECT_THAT(files("again"), Contains(HasSubstr("scattered.exr")));
}

TEST_F(Render, NoGraph_ShowsTheEnginesPicture) {
  const Outcome outcome = render(bust, "none", {"--frames", "1"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(files("out"), ::testing::ElementsAre("color_0000.exr", "frame_0000.png"));
  EXPECT_THAT(outcome.out, HasSubstr("rendered without a graph"));
  EXPECT_EQ(render(bust, "none", {"--set", "samples=8"}).exit_code, 2);
}

TEST_F(Render, MissingScene_IsNamed) {
  const Outcome outcome = render("configs/scenes/none.json", burley);
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err, HasSubstr("configs/scenes/none.json"));
  EXPECT_THAT(files(), IsEmpty());
}

TEST_F(Render, GraphWithErrors_WritesNothing) {
  const std::string bad = write("bad.json", "{ \"dermis\": 2, \"name\": \"x\" ");
  const Outcome outcome = render(bust, bad);
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err, HasSubstr(bad + ":1:"));
  EXPECT_THAT(files("out"), IsEmpty());
}

TEST_F(Render, ModelThatIsNotGltf_IsNamed) {
  const std::string model = write("model.glb", "this is no model");
  const Outcome outcome = render("configs/scenes/head.json", burley, {"--model", model});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err, HasSubstr("model.glb"));
  EXPECT_THAT(files("out"), IsEmpty());
}

TEST_F(Render, UnwritableFolder_IsAnEnvironmentError) {
  const std::string file = write("file", "");
  const Outcome outcome =
      run({"render", bust, "--graph", burley, "--size", "64x36", "--frames", "1", "--out", file + "/out"});
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("output folder"), HasSubstr(file + "/out")));
}

TEST_F(Render, NoVulkanDriver_IsAnEnvironmentError) {
  RunOptions options;
  options.environment = {"VK_ICD_FILENAMES=/nonexistent.json", "VK_DRIVER_FILES=/nonexistent.json"};
  const Outcome outcome = render(bust, burley, {}, options);
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_THAT(outcome.err, HasSubstr("Vulkan"));
  EXPECT_THAT(files(), IsEmpty());
}

TEST_F(Render, CtrlC_StopsAtTheNextFrameWithCompleteFiles) {
  RunOptions options;
  options.interrupt_after = path("out/frame_0000.png");
  const Outcome outcome = render(bust, burley, {"--frames", "10000"}, options);
  EXPECT_EQ(outcome.exit_code, 130);
  EXPECT_THAT(outcome.err, HasSubstr("stopped"));
  const std::vector<std::string> left = files("out");
  EXPECT_THAT(left, Each(::testing::AnyOf(::testing::EndsWith(".png"), ::testing::EndsWith(".exr"))));
  EXPECT_THAT(left, Not(Contains("frame_9999.png")));
}

} // namespace
} // namespace dermis::test
