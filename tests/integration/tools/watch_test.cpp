// Tests `dermis watch`: after a file changes, it reports the change of plan and error.
#include "tests/integration/tools/command_fixture.hpp"

#include <chrono>
#include <functional>
#include <thread>

namespace dermis::test {
namespace {

using namespace std::chrono_literals;

class Watch : public CommandTest {
protected:
  std::string copy(const std::string& from, const std::string& to) const {
    return write(to, read_text(from));
  }
  std::vector<std::string> arguments(const std::string& graph, const std::string& rounds) const {
    return {"watch",    "configs/scenes/bust.json",
            "--graph",  graph,
            "--size",   "48x27",
            "--frames", "1",
            "--subset", "16",
            "--rounds", rounds,
            "--out",    path("out")};
  }
  // Runs `work` once the first rendering exists.
  std::thread after_the_first(std::function<void()> work) const {
    return std::thread([picture = path("out/color_0000.exr"), work = std::move(work)] {
      for (int i = 0; i < 600 && !std::filesystem::exists(picture); ++i)
        std::this_thread::sleep_for(100ms);
      std::this_thread::sleep_for(500ms); // Changes are detected by file times.
      work();
    });
  }
};

TEST_F(Watch, ChangedGraph_ReportsPlanAndError) {
  const std::string graph = copy("configs/graphs/burley.json", "graph.json");
  std::thread editor =
      after_the_first([&] { copy("configs/graphs/separable.json", "graph.json"); });
  const Outcome outcome = run(arguments(graph, "2"));
  editor.join();
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out,
              HasAll("graph.json changed", "horizontal")); // A pass that burley does not have.
  EXPECT_THAT(outcome.out, ::testing::ContainsRegex("PSNR [0-9.]+ dB \\([+-][0-9.]+\\)"));
}

TEST_F(Watch, FileWithErrors_WatchingContinues) {
  const std::string graph = copy("configs/graphs/burley.json", "graph.json");
  std::thread editor = after_the_first([&] {
    write("graph.json", "{ \"dermis\": 2, ");
    std::this_thread::sleep_for(1500ms);
    copy("configs/graphs/burley.json", "graph.json");
  });
  const Outcome outcome = run(arguments(graph, "3"));
  editor.join();
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.err, HasSubstr("graph.json:1:"));
  EXPECT_THAT(outcome.out, HasSubstr("plan: unchanged"));
}

TEST_F(Watch, ExitCodeIsThatOfTheLastRound) {
  write("graph.json", "{ \"dermis\": 2, ");
  EXPECT_EQ(run(arguments(path("graph.json"), "1")).exit_code, 1);
}

TEST_F(Watch, ChangedShader_RunsTheBuildCommand) {
  write("shaders/kernel.comp", "before");
  std::thread editor = after_the_first([&] { write("shaders/kernel.comp", "behind it"); });
  std::vector<std::string> words = arguments("configs/graphs/burley.json", "2");
  words.insert(words.end(),
               {"--shaders", path("shaders"), "--build", "echo built > '" + path("built") + "'"});
  const Outcome outcome = run(words);
  editor.join();
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_TRUE(std::filesystem::exists(path("built")));
  EXPECT_THAT(outcome.out, HasSubstr("kernel.comp changed"));
}

// Renders again with the folder's text: a broken text is reported with its place, a good text takes
// effect.
TEST_F(Watch, ChangedShader_IsRendered) {
  if (!has_shader_compiler()) GTEST_SKIP() << "built without glslang (package glslang-dev)";
  copy_shaders();
  const std::string kernel = "shaders/common/subsurface_combine.comp",
                    store = "settings.result, albedo, color)";
  const auto change = [&](const std::string& to) {
    write(kernel, replaced(read_text(kernel), store, to));
  };
  std::thread editor = after_the_first([&] {
    change("settings.result, albedo, colour)");
    std::this_thread::sleep_for(3s);
    change("settings.result, albedo, 0.5 * color)");
  });
  std::vector<std::string> words = arguments("configs/graphs/burley.json", "3");
  words.insert(words.end(), {"--shaders", path("shaders")});
  const Outcome outcome = run(words);
  editor.join();
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("common/subsurface_combine.comp changed"));
  EXPECT_THAT(outcome.err,
              ::testing::ContainsRegex(
                  "common/subsurface_combine.comp:[0-9]+:[0-9]+: error.D0615 shader_error"));
  EXPECT_THAT(outcome.out, ::testing::ContainsRegex("PSNR [0-9.]+ dB \\([+-][0-9.]+\\)"));
}

TEST_F(Watch, CtrlC_EndsWatching) {
  RunOptions options;
  options.interrupt_after = path("out/color_0000.exr");
  EXPECT_EQ(run(arguments("configs/graphs/burley.json", "0"), options).exit_code, 130);
}

} // namespace
} // namespace dermis::test
