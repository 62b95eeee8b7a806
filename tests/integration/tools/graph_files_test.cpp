// Tests validate, explain and graph: good files succeed; messages about wrong files say where, what
// and what to do.

#include "tests/integration/tools/capture_builder.hpp"
#include "tests/integration/tools/command_fixture.hpp"

#include <fmt/format.h>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace dermis::test {
namespace {

using GraphFiles = CommandTest;

// Returns the shipped graph with one part of its text replaced.
std::string burley_with(const std::string& from, const std::string& to) {
  return replaced(read_text(std::string(DERMIS_SOURCE_DIR "/") + burley), from, to);
}

TEST_F(GraphFiles, TheShippedFilesHaveNoProblems) {
  std::vector<std::string> words{"validate"};
  for (const char* folder : {"graphs", "profiles", "scenes"})
    for (const auto& entry : std::filesystem::recursive_directory_iterator(
             fmt::format("{}/configs/{}", DERMIS_SOURCE_DIR, folder)))
      if (entry.is_regular_file()) words.push_back(entry.path().string());
  EXPECT_THAT(run(words),
              Succeeds("burley.json: graph, no problems",
                       "burley.expect.json: expectations, no problems",
                       "skin.json: profile, no problems", "bust.json: scene, no problems"));
}

TEST_F(GraphFiles, FormatTooSmallForTheStorage_IsReported) {
  const std::string overlay = write("full.json", R"({ "dermis_overlay": 2, "edits": [
    { "set": "/passes/down_1/set/storage", "to": "full" } ] })");
  EXPECT_THAT(run({"validate", "configs/graphs/sap.json", "--overlay", overlay}),
              FailsWith(1, "D0304", "'second_light_1'", "not rg16f",
                        "'second_coarse_light' of pass 'down_1'", "setting 'storage'"));
  EXPECT_THAT(run({"validate", "configs/graphs/sap.json", "--overlay",
                   "configs/overlays/sap_full_precision.json"}),
              Succeeds("no problems"));
}

TEST_F(GraphFiles, LayersThatAKernelDoesNotDeclare_AreRejected) {
  const std::string light = R"("light": { "format": "rgba16f", "size": "view",)";
  const std::string layered = burley_with(light, light + R"( "layers": 2,)");
  EXPECT_THAT(run({"validate", write("whole.json", layered)}),
              FailsWith(1, "D0228", "port 'light' of pass", "accesses one layer, but 'light' has 2",
                        "'light[0]'"));
  const std::string one = replaced(
      replaced(layered, R"("write": { "light": "light",)", R"("write": { "light": "light[0]",)"),
      R"("read": { "light": "light",)", R"("read": { "light": "light[0]",)");
  EXPECT_THAT(run({"validate", write("one.json", one)}), Succeeds("no problems"));
}

TEST_F(GraphFiles, ConfigurationsOfABudget_AreCompiled) {
  const std::string scatter = R"("type": "subsurface.burley",)";
  std::string graph = burley_with(R"("settings": {)", R"("settings": {
    "t": { "choice": ["a", "b"], "by": "budget", "default": "a" },)");
  graph = replaced(graph, scatter, scatter + R"( "when": "t == 'a'",)");
  EXPECT_THAT(run({"validate", write("choice.json", graph)}), FailsWith(1, "D0307", "with 't' = 'b'"));
}

TEST_F(GraphFiles, MalformedJsonIsNamedWithFileLineAndColumn) {
  const std::string bad = write("bad.json", "{ \"dermis\": 2,\n  \"name\": }\n");
  const Outcome outcome = run({"validate", bad});
  EXPECT_THAT(outcome, FailsWith(1, bad + ":2:11: error[D0101 syntax]", "^"));
  EXPECT_THAT(outcome.out, IsEmpty());
}

TEST_F(GraphFiles, UnknownKey_SuggestsTheNearest) {
  const std::string bad = write("bad.json", burley_with("\"imports\"", "\"import\""));
  EXPECT_THAT(run({"validate", bad}), FailsWith(1, "D0103", "did you mean 'imports'?"));
}

TEST_F(GraphFiles, FileOfNoKnownKind_ListsTheKinds) {
  const std::string scene = write("scene.json", R"({ "camera": {}, "objects": [] })");
  EXPECT_THAT(run({"validate", scene}),
              FailsWith(1, "scene.json:1:1", "must state its kind", "\"dermis_scene\": 1 (scene)"));
  EXPECT_THAT(run({"upgrade", "--check", scene}), FailsWith(1, "must state its kind"));
  const std::string misspelt = write("misspelt.json", R"({ "dermis_scen": 1, "camera": {} })");
  EXPECT_THAT(run({"validate", misspelt}), FailsWith(1, "did you mean 'dermis_scene'?"));
}

TEST_F(GraphFiles, MissingImportIsNamedWithItsReader) {
  const std::string bad =
      write("bad.json", burley_with("\"depth\": { \"format\"", "\"other\": { \"format\""));
  EXPECT_THAT(run({"validate", bad}), FailsWith(1, bad + ":", "'depth'", "'classify'"));
}

TEST_F(GraphFiles, CycleNamesItsPasses) {
  // `setup` reads the output of `scatter`, and `scatter` reads the output of `setup`.
  const std::string bad =
      write("bad.json",
            burley_with("\"read\": { \"lighting\": \"lighting\", \"material\": \"material\", "
                        "\"depth\": \"depth\", \"albedo\": \"albedo\",",
                        "\"read\": { \"lighting\": \"scattered\", \"material\": \"material\", "
                        "\"depth\": \"depth\", \"albedo\": \"albedo\","));
  EXPECT_THAT(run({"validate", bad}), FailsWith(1, bad + ":", "cycle", "'setup'", "'scatter'"));
}

TEST_F(GraphFiles, UnusableFormatIsNamedWithBothSides) {
  const std::string bad =
      write("bad.json", burley_with(R"("format": ["r8_uint", "r16_uint", "r32_uint"])",
                                    R"("format": "rgba16f")"));
  EXPECT_THAT(run({"validate", bad}), FailsWith(1, bad + ":", "'material'", "rgba16f"));
}

TEST_F(GraphFiles, MissingFileIsNamed) {
  EXPECT_THAT(run({"validate", path("none.json")}), FailsWith(1, "none.json"));
}

TEST_F(GraphFiles, AllFilesAreCheckedAfterABadOne) {
  const std::string bad = write("bad.json", "[");
  const Outcome outcome = run({"validate", bad, burley, "--json"});
  EXPECT_EQ(outcome.exit_code, 1);
  ASSERT_TRUE(is_json(outcome.out)) << outcome.out;
  EXPECT_THAT(outcome.out, AllOf(StartsWith("{\n  \"ok\": false,"),
                                 HasSubstr("burley.json\", \"kind\": \"graph\", \"ok\": true")));
}

TEST_F(GraphFiles, AGraphIsReadFromStandardInput) {
  RunOptions options;
  options.input = "{ \"dermis\": 3 }";
  EXPECT_THAT(run({"validate", "-"}, options), FailsWith(1, "<stdin>:1:13"));
}

// A kernel that reads one layer gets no image of several, in any frame.
TEST_F(GraphFiles, ReplacementWithOtherLayers_IsRejected) {
  const std::string stack =
      R"({ "set": "/resources/stack", "to": { "format": "rgba16f", "size": "view", "layers": 4 } })";
  const auto overlay = [&](const std::string& edit) {
    return write("stack.json",
                 R"({ "dermis_overlay": 2, "edits": [ )" + stack + ", " + edit + "] }");
  };
  EXPECT_THAT(run({"validate", burley, "--overlay", "configs/overlays/accumulate.json", "--overlay",
                   overlay(R"({ "set": "/passes/accumulate/read/past",
             "to": { "from": "past@-1", "requires": "valid", "otherwise": "stack" } })")}),
              FailsWith(1, "'otherwise' of port 'past' of pass 'accumulate' accesses one layer",
                        "'stack' has 4"));
  EXPECT_THAT(
      run({"validate", burley, "--overlay", overlay(R"({ "insert_before": "classify", "passes": [
                       { "pass": "fill", "type": "clear", "write": { "target": "stack" } } ] },
                     { "set": "/settings/on", "to": { "bool": true } },
                     { "set": "/passes/scatter/when", "to": "on" },
                     { "set": "/passes/scatter/otherwise", "to": { "scattered": "stack" } })")}),
      FailsWith(1, "accesses one layer, but the replacement 'stack' of 'scattered' has 4"));
}

TEST_F(GraphFiles, StandardInput_CanBeBothSidesOfADiff) {
  RunOptions options;
  options.input = read_text(burley);
  const Outcome from_file = run({"plan", "diff", burley, "--b-size", "960x540"});
  const Outcome from_input = run({"plan", "diff", "-", "--b-size", "960x540"}, options);
  ASSERT_THAT(from_file, Succeeds());
  ASSERT_THAT(from_input, Succeeds());
  EXPECT_EQ(from_input.out, replaced(replaced(from_file.out, burley, "-"), burley, "-"));
}

TEST_F(GraphFiles, ExplainShowsEachPassOfThePlan) {
  const Outcome outcome = run({"explain", burley, "--size", "640x360"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  for (const char* pass : {"classify", "list", "setup", "scatter", "combine"})
    EXPECT_THAT(outcome.out, HasSubstr(pass));
  EXPECT_THAT(run({"explain", burley, "--json"}), Succeeds(IsJson()));
}

TEST_F(GraphFiles, ExplainDescribesADiagnosticCode) {
  const Outcome outcome = run({"explain", "D0103"});
  EXPECT_THAT(outcome, Succeeds(StartsWith("D0103 unknown_key (error)\n")));
  // From docs/diagnostics.md.
  EXPECT_THAT(outcome.out, HasSubstr("The nearest known key is suggested"));
  for (const char* code : {"d0103", "103", "0103"})
    EXPECT_EQ(run({"explain", code}).out, outcome.out) << code;
  EXPECT_THAT(run({"explain", "D0999"}), FailsWith(2, "there is no message D0999"));
  EXPECT_TRUE(is_json(run({"explain", "D0103", "--json"}).out));
}

TEST_F(GraphFiles, GraphWritesDotAndJson) {
  EXPECT_THAT(run({"graph", burley}), Succeeds(StartsWith("digraph")));
  const Outcome json = run({"graph", burley, "--json", "--out", path("plan.json")});
  EXPECT_EQ(json.exit_code, 0) << json.err;
  EXPECT_THAT(files(), ElementsAre("plan.json"));
}

TEST_F(GraphFiles, UnwritableOutput_IsAnEnvironmentError) {
  EXPECT_THAT(run({"graph", burley, "--out", path("no/such/folder.dot")}),
              FailsWith(3, "no/such/folder.dot"));
  EXPECT_THAT(files(), IsEmpty());
}

TEST_F(GraphFiles, OutputIntoAPipe_KeepsThePipe) {
  const std::string pipe = path("pipe");
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  const int reader = ::open(pipe.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  ASSERT_GE(reader, 0);
  EXPECT_THAT(run({"graph", burley, "--out", pipe}), Succeeds());
  EXPECT_TRUE(std::filesystem::is_fifo(pipe));
  char text[8] = {};
  EXPECT_EQ(::read(reader, text, 7), 7);
  EXPECT_STREQ(text, "digraph");
  ::close(reader);
}

TEST_F(GraphFiles, MessagesAreWrittenAsSarif) {
  const std::string bad = write("bad.json", burley_with("\"imports\"", "\"import\""));
  EXPECT_THAT(run({"validate", bad, "--sarif", path("out.sarif")}), FailsWith(1, "D0103"));
  const Outcome log = run({"validate", bad, "--sarif", "-"});
  EXPECT_EQ(log.exit_code, 1);
  ASSERT_TRUE(is_json(log.out)) << log.out;
  EXPECT_EQ(read("out.sarif"), log.out);
  EXPECT_THAT(log.out, HasAll("\"ruleId\": \"D0103\"", "\"version\": \"2.1.0\""));
  EXPECT_THAT(run({"validate", burley, "--sarif", "-"}), Succeeds(IsJson()));
  EXPECT_EQ(run({"validate", burley, "--sarif", "-", "--json"}).exit_code, 2);
  EXPECT_EQ(run({"validate", burley, "--sarif", path("no/such.sarif")}).exit_code, 3);
}

TEST_F(GraphFiles, CaptureIsCheckedAsAFileOrFolder) {
  write_plane(path("capture"));
  for (const std::string& one : {path("capture"), path("capture/frame.json")}) {
    EXPECT_THAT(run({"validate", one}), Succeeds("frame.json: capture, no problems"));
  }
  Plane named;
  named.profiles = R"([{ "id": 1, "file": "skin" }])";
  write_plane(path("named"), named);
  EXPECT_EQ(run({"validate", path("named")}).exit_code, 0);
  EXPECT_THAT(run({"validate", path("named"), "--profiles", path("capture")}),
              FailsWith(1, "profile 'skin' does not exist"));
  write("capture/lighting.exr", "no picture");
  EXPECT_THAT(run({"validate", path("capture")}), FailsWith(1, "lighting.exr"));
  EXPECT_THAT(run({"validate", "docs"}), FailsWith(1, "the folder 'docs' is not a capture"));
}

TEST_F(GraphFiles, Upgrade_NewestAndUnknownVersions) {
  const std::string text = burley_with("\"burley\"", "\"mine\"");
  const std::string mine = write("mine.json", text);
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"upgrade", mine}, {"upgrade", "--check", mine}}) {
    EXPECT_THAT(run(words), Succeeds("graph, version 2 is the newest: nothing to"));
  }
  EXPECT_THAT(files(), ElementsAre("mine.json"));
  const std::string newer = write("newer.json", "{ \"dermis_scene\": 7 }");
  const Outcome rejected = run({"upgrade", "--check", newer, mine, "--json"});
  EXPECT_EQ(rejected.exit_code, 1);
  ASSERT_TRUE(is_json(rejected.out));
  EXPECT_THAT(rejected.out, HasAll("\"kind\": \"scene\", \"version\": null", "D0110",
                                   "\"kind\": \"graph\", \"version\": 2, \"changed\": false"));
}

TEST_F(GraphFiles, OverlaysApplyInOrder_ExplainNamesTheirFiles) {
  const std::string first = write("first.json", R"({ "dermis_overlay": 2, "edits": [
    { "set": "/settings/samples/int", "to": 8 }, { "remove": "/passes/export_scattered" },
    { "remove": "/exports/scattered_light" }, { "remove": "/resources/scattered_light" } ] })");
  const std::string second = write("second.json", R"({ "dermis_overlay": 2, "edits": [
    { "set": "/settings/samples/int", "to": 16 } ] })");
  for (const char* verb : {"validate", "explain", "graph"}) {
    EXPECT_THAT(run({verb, burley, "--overlay", first, "--overlay", second}), Succeeds()) << verb;
  }
  const Outcome text = run({"explain", burley, "--overlay", first, "--overlay", second});
  EXPECT_THAT(text.out, HasAll("remove   /passes/export_scattered  (" + first + ":2:62)",
                               "set      /settings/samples/int  (" + second + ":2:14)"));
  const Outcome json = run({"explain", burley, "--json", "--overlay", second, "--overlay", first});
  ASSERT_TRUE(is_json(json.out));
  EXPECT_THAT(json.out,
              HasAll("\"name\": \"samples\", \"type\": \"int\", \"value\": 8",
                     "{ \"did\": \"set\", \"at\": \"/settings/samples/int\", \"file\": \"" + first +
                         "\", \"line\": 2, \"column\": 14 }"));
}

TEST_F(GraphFiles, OverlayError_IsReportedInTheOverlay) {
  const std::string wrong = write("wrong.json", R"({ "dermis_overlay": 2,
  "edits": [ { "set": "/settings/samples/int", "to": 1 } ] })");
  for (const char* verb : {"validate", "explain", "graph"}) {
    EXPECT_THAT(run({verb, burley, "--overlay", wrong}),
                FailsWith(1, wrong + ":2:54: error[D0223", "burley.json:"));
  }
  EXPECT_EQ(run({"validate", wrong}).exit_code, 0) << "without a graph the file is an overlay";
  EXPECT_EQ(run({"validate", wrong, "--overlay", wrong}).exit_code, 2) << "there is no graph";
  EXPECT_THAT(run({"explain", burley, "--overlay", path("none.json")}), FailsWith(1, "none.json"));
}

TEST_F(GraphFiles, IncludesAreReadBelowFolderAndRoots) {
  const std::string classify = R"({ "pass": "classify", "type": "subsurface.classify",
      "read": { "material": "material", "depth": "depth", "scatter_scale": "scatter_scale" },
      "write": { "classes": "classes", "list_state": "list_state" } })";
  const std::string graph =
      write("graphs/mine.json", burley_with(classify, R"({ "include": "parts/classify.json" })"));
  EXPECT_THAT(run({"validate", graph}), FailsWith(1, "D0109", "there is no such file in"));
  write("shared/parts/classify.json",
        "{ \"dermis_fragment\": 2, \"passes\": [ " + classify + " ] }");
  EXPECT_THAT(run({"validate", graph, "--root", path("shared")}), Succeeds());
  EXPECT_THAT(run({"validate", path("shared/parts/classify.json")}),
              FailsWith(1, "classify.json:2:29: error[D0203"))
      << "the file does not declare its resources";
}

TEST_F(GraphFiles, SceneProfilesAreReadInFolderAndRoots) {
  write("elsewhere/secret.json", "{ \"dermis_profile\": 1 }");
  const std::string scene = write("here/scene.json", R"({ "dermis_scene": 1, "name": "s",
  "profiles": [ { "name": "skin", "file": "../elsewhere/secret.json" } ],
  "camera": { "position": [0, 0, 1], "target": [0, 0, 0], "vertical_fov": 20 },
  "objects": [ { "shape": "sphere", "profile": "skin" } ] })");
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"validate", scene},
        {"render", scene, "--graph", "none", "--out", path("out")},
        {"capture", scene, "--out", path("out")}}) {
    EXPECT_THAT(run(words), FailsWith(1, "scene.json:2:43: error[D0118",
                                      "outside the readable folders", "--root"))
        << words[0];
    EXPECT_FALSE(std::filesystem::exists(path("out"))) << words[0];
  }
  const std::vector<std::string> words{"validate", scene, "--root", path("elsewhere")};
  EXPECT_THAT(run(words), FailsWith(1, "secret.json:1:1: error[D0105"));
  std::filesystem::copy(DERMIS_SOURCE_DIR "/configs/profiles/skin.json",
                        path("elsewhere/secret.json"),
                        std::filesystem::copy_options::overwrite_existing);
  EXPECT_THAT(run(words), Succeeds("no problems"));
}

} // namespace
} // namespace dermis::test
