// Tests capture, report-bug and render --trace: other verbs and programs accept their output.
#include "tests/integration/tools/command_fixture.hpp"

#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdlib>
#include <map>

namespace dermis::test {
namespace {

using nlohmann::json;

class Keep : public CommandTest {};

TEST_F(Keep, CapturedSceneIsValidAndCanBeApplied) {
  ASSERT_THAT(run({"capture", "configs/scenes/bust.json", "--out", path("capture"), "--size",
                   "48x27", "--frames", "2", "--first", "3"}),
              Succeeds());
  EXPECT_EQ(run({"validate", path("capture")}).exit_code, 0);
  EXPECT_THAT(run({"apply", "--graph", "configs/graphs/burley.json", "--frames", path("capture"),
                   "--out", path("out")}),
              Succeeds());
  EXPECT_THAT(files("out"), Contains("frame_0001/scattered.exr"));
}

TEST_F(Keep, CaptureReplacesACaptureButNoOtherFiles) {
  const std::vector<std::string> command = {"capture",  "configs/scenes/bust.json",
                                            "--out",    path("capture"),
                                            "--size",   "48x27",
                                            "--frames", "1"};
  ASSERT_THAT(run(command), Succeeds());
  ASSERT_THAT(run(command), Succeeds()) << "replaces the first";
  for (const char* name :
       {"capture/notes.txt", "capture/frame_0000/light.blend", "capture/mine/a"}) {
    std::filesystem::create_directories(std::filesystem::path(path(name)).parent_path());
    write(name, "mine");
    const std::string shown = std::filesystem::path(name).lexically_relative("capture").string();
    EXPECT_THAT(run(command), FailsWith(3, shown.substr(0, shown.rfind("/a")))) << name;
    EXPECT_EQ(read(name), "mine");
    std::filesystem::remove(path(name));
    std::filesystem::remove(path("capture/mine"));
  }
}

TEST_F(Keep, CaptureMatchesTheCaptureOfARendering) {
  ASSERT_EQ(run({"capture", "configs/scenes/bust.json", "--out", path("a"), "--size", "48x27",
                 "--frames", "1"})
                .exit_code,
            0);
  ASSERT_EQ(run({"render", "configs/scenes/bust.json", "--graph", "configs/graphs/burley.json",
                 "--capture", path("b"), "--out", path("out"), "--size", "48x27", "--frames", "1",
                 "--subset", "0"})
                .exit_code,
            0);
  ASSERT_EQ(files("a"), files("b"));
  for (const std::string& file : files("a"))
    EXPECT_EQ(read("a/" + file), read("b/" + file)) << file; // Folders read as "".
}

TEST_F(Keep, BugReportIsCompleteAndReproducible) {
  const Outcome outcome = run({"report-bug", "configs/graphs/burley.json", "--overlay",
                               "configs/overlays/full_precision.json", "--set", "samples=8",
                               "--size", "48x27", "--count", "1", "--out", path("bug"), "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  for (const char* file :
       {"graph/burley.json", "overlays/0_full_precision.json", "settings.json", "plan.json",
        "graph.plan", "device.json", "README.txt", "capture/frame_0000/frame.json"})
    EXPECT_THAT(files("bug"), Contains(file));
  EXPECT_EQ(json::parse(read("bug/settings.json"))["samples"], 8);
  EXPECT_TRUE(json::parse(read("bug/plan.json")).contains("reasons"));
  EXPECT_TRUE(json::parse(read("bug/device.json")).contains("ok"));
  EXPECT_EQ(run({"plan", "verify", path("bug/graph.plan")}).exit_code, 0);

  const std::string replay = json::parse(outcome.out)["replay"];
  EXPECT_EQ(replay,
            "dermis apply --graph graph/burley.json --frames capture --out replay --overlay "
            "overlays/0_full_precision.json --set samples=8");
  EXPECT_THAT(read("bug/README.txt"), HasSubstr(replay));
  // The line of the report, run from the test's working folder.
  EXPECT_THAT(run({"apply", "--graph", path("bug/graph/burley.json"), "--frames",
                   path("bug/capture"), "--out", path("replay"), "--overlay",
                   path("bug/overlays/0_full_precision.json"), "--set", "samples=8"}),
              Succeeds());
  EXPECT_THAT(files("replay"), Contains("frame_0000/combined.exr"));
}

TEST_F(Keep, BugReport_HasTheLastFrameAndIncludedFiles) {
  ASSERT_EQ(run({"capture", "configs/scenes/bust.json", "--out", path("capture"), "--size", "32x18",
                 "--frames", "2"})
                .exit_code,
            0);
  write("graphs/parts/back.json", R"({ "dermis_fragment": 2, "passes": [
    { "pass": "combine", "type": "subsurface.combine", "read": { "scattered": "light", "material": "material",
      "tiles": "tiles", "arguments": "arguments" }, "write": { "lighting": "lighting" } } ] })");
  const std::string graph = write("graphs/main.json", R"({ "dermis": 2, "name": "main",
    "imports": { "lighting": { "format": "rgba16f", "size": "view" }, "depth": { "format": "depth", "size": "view" },
      "material": { "format": "r8_uint", "size": "view" } },
    "resources": { "classes": { "buffer": { "stride": 4, "count": "view/8" } },
      "list_state": { "buffer": { "stride": 4, "count": "view/64", "extra": 8 } },
      "tiles": { "buffer": { "stride": 4, "count": "view/8", "extra": 1 } },
      "arguments": { "buffer": { "stride": 4, "count": [4, 1] } }, "light": { "format": "rgba16f", "size": "view" } },
    "passes": [
      { "pass": "classify", "type": "subsurface.classify", "read": { "material": "material", "depth": "depth" }, "write": { "classes": "classes", "list_state": "list_state" } },
      { "pass": "list", "type": "subsurface.tile_list", "read": { "classes": "classes" }, "write": { "list_state": "list_state", "tiles": "tiles", "arguments": "arguments" } },
      { "pass": "setup", "type": "subsurface.setup", "read": { "lighting": "lighting", "material": "material", "depth": "depth",
        "tiles": "tiles", "arguments": "arguments" }, "write": { "light": "light" } },
      { "include": "parts/back.json" } ],
    "exports": ["lighting"] })");
  ASSERT_THAT(run({"report-bug", graph, "--frames", path("capture"), "--out", path("bug")}),
              Succeeds());
  EXPECT_EQ(json::parse(read("bug/plan.json"))["view"], json({32, 18}));
  EXPECT_THAT(files("bug"), Contains("graph/parts/back.json"));
  EXPECT_THAT(files("bug/capture"), Not(Contains("frame_0001")));
  EXPECT_EQ(run({"validate", path("bug/graph/main.json"), path("bug/capture")}).exit_code, 0);
}

TEST_F(Keep, BugReport_GraphMayHaveTheNameOfAnotherFile) {
  const std::string graph = write("plan.json", read_text("configs/graphs/burley.json"));
  ASSERT_THAT(run({"report-bug", graph, "--size", "32x18", "--count", "1", "--out", path("bug")}),
              Succeeds());
  EXPECT_EQ(read("bug/graph/plan.json"), read_text(graph));
  EXPECT_TRUE(json::parse(read("bug/plan.json")).contains("reasons"));
}

TEST_F(Keep, BugReportCanBeAnArchive) {
  ASSERT_THAT(run({"report-bug", "configs/graphs/burley.json", "--size", "32x18", "--count", "1",
                   "--out", path("bug.tar.gz")}),
              Succeeds());
  EXPECT_THAT(files(), ElementsAre("bug.tar.gz"));
  EXPECT_THAT(run({"report-bug", "configs/graphs/burley.json", "--out", path("bug.tar.gz")}),
              FailsWith(3, "exists: choose another name"));
  EXPECT_THAT(run({"report-bug", "configs/graphs/burley.json", "--out", path("bug.zip")}),
              FailsWith(2, ".tar.gz or .tgz"));
  ASSERT_EQ(std::system(("tar -xzf " + path("bug.tar.gz") + " -C " + path(".")).c_str()), 0);
  EXPECT_THAT(run({"apply", "--graph", path("bug/graph/burley.json"), "--frames",
                   path("bug/capture"), "--out", path("replay")}),
              Succeeds());
}

TEST_F(Keep, BugReport_IsWrittenCompletelyToANewFolder) {
  write("full/file", "x");
  EXPECT_EQ(run({"report-bug", "configs/graphs/burley.json", "--out", path("full")}).exit_code, 3);
  EXPECT_EQ(run({"report-bug", "configs/graphs/burley.json", "--scene", path("none.json"), "--out",
                 path("bug")})
                .exit_code,
            1);
  EXPECT_THAT(files(), ElementsAre("full", "full/file"));
}

TEST_F(Keep, TraceHasEveryPassAndNestsPerfectly) {
  const Outcome outcome =
      run({"render", "configs/scenes/bust.json", "--graph", "configs/graphs/skin.json", "--size",
           "48x27", "--frames", "3", "--subset", "0", "--budget", "1000", "--out", path("out"),
           "--trace", path("trace.json"), "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const json passes = json::parse(outcome.out)["passes"];
  const json trace = json::parse(read("trace.json"));
  std::map<std::string, int> seen;
  std::map<int, std::vector<std::pair<double, double>>> tracks;
  int counters = 0, choices = 0;
  for (const json& event : trace.at("traceEvents")) {
    const std::string phase = event.at("ph");
    counters += phase == "C";
    choices += phase == "i";
    if (phase != "X") continue;
    EXPECT_GE(event.at("dur").get<double>(), 0.0);
    tracks[event.at("tid")].emplace_back(event.at("ts"), event.at("dur"));
    ++seen[event.at("name")];
  }
  for (const json& pass : passes)
    EXPECT_GE(seen[pass.at("pass")], pass.at("frames").get<int>()) << pass; // others warm up
  EXPECT_EQ(seen["classify"], 3); // runs with each technique
  EXPECT_EQ(seen["combine"], 3);
  for (const char* phase :
       {"record scene", "run scene", "read inputs", "record graph", "run graph", "read pictures"})
    EXPECT_EQ(seen[phase], 3) << phase;
  EXPECT_EQ(seen["frame 2"], 1);
  EXPECT_EQ(counters, 6);
  EXPECT_GE(choices, 1);
  // Each span of a track ends before the next begins, or contains it entirely, in microseconds
  // within rounding.
  for (auto& [track, spans] : tracks) {
    std::vector<double> ends;
    for (const auto& [begin, duration] : spans) {
      while (!ends.empty() && ends.back() <= begin + 1e-6)
        ends.pop_back();
      EXPECT_TRUE(ends.empty() || begin + duration <= ends.back() + 1e-6) << "track " << track;
      ends.push_back(begin + duration);
    }
  }
}

} // namespace
} // namespace dermis::test
