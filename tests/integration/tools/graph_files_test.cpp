// Tests validate, explain and graph: good files succeed; messages about wrong files say where, what
// and what to do.

#include "tests/integration/tools/capture_builder.hpp"
#include "tests/integration/tools/command_fixture.hpp"

#include <fmt/format.h>

#include <fstream>
#include <sstream>

namespace dermis::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

using GraphFiles = CommandTest;

// Returns the shipped graph with one part of its text replaced.
std::string burley_with(const std::string& from, const std::string& to) {
  std::ifstream stream(std::string(DERMIS_SOURCE_DIR "/") + burley);
  std::ostringstream text;
  text << stream.rdbuf();
  std::string all = text.str();
  const size_t at = all.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? all : all.replace(at, from.size(), to);
}

TEST_F(GraphFiles, TheShippedFilesHaveNoProblems) {
  std::vector<std::string> words{"validate"};
  for (const char* folder : {"graphs", "profiles", "scenes"})
    for (const auto& entry : std::filesystem::recursive_directory_iterator(
             fmt::format("{}/configs/{}", DERMIS_SOURCE_DIR, folder)))
      if (entry.is_regular_file()) words.push_back(entry.path().string());
  const Outcome outcome = run(words);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("burley.json: graph, no problems"));
  EXPECT_THAT(outcome.out, HasSubstr("burley.expect.json: expectations, no problems"));
  EXPECT_THAT(outcome.out, HasSubstr("skin.json: profile, no problems"));
  EXPECT_THAT(outcome.out, HasSubstr("bust.json: scene, no problems"));
}

TEST_F(GraphFiles, MalformedJsonIsNamedWithFileLineAndColumn) {
  const std::string bad = write("bad.json", "{ \"dermis\": 2,\n  \"name\": }\n");
  const Outcome outcome = run({"validate", bad});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err, AllOf(HasSubstr(bad + ":2:11: error[D0101 syntax]"), HasSubstr("^")));
  EXPECT_THAT(outcome.out, IsEmpty());
}

TEST_F(GraphFiles, UnknownKey_SuggestsTheNearest) {
  const std::string bad = write("bad.json", burley_with("\"imports\"", "\"import\""));
  const Outcome outcome = run({"validate", bad});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("D0103"), HasSubstr("did you mean 'imports'?")));
}

TEST_F(GraphFiles, MissingImportIsNamedWithItsReader) {
  const std::string bad =
      write("bad.json", burley_with("\"depth\": { \"format\"", "\"other\": { \"format\""));
  const Outcome outcome = run({"validate", bad});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err, AllOf(HasSubstr(bad + ":"), HasSubstr("'depth'"), HasSubstr("'classify'")));
}

TEST_F(GraphFiles, CycleNamesItsPasses) {
  // `setup` reads the output of `scatter`, and `scatter` reads the output of `setup`.
  const std::string bad =
      write("bad.json", burley_with("\"read\": { \"lighting\": \"lighting\", \"material\": \"material\", "
                                    "\"depth\": \"depth\", \"albedo\": \"albedo\",",
                                    "\"read\": { \"lighting\": \"scattered\", \"material\": \"material\", "
                                    "\"depth\": \"depth\", \"albedo\": \"albedo\","));
  const Outcome outcome = run({"validate", bad});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err,
              AllOf(HasSubstr(bad + ":"), HasSubstr("cycle"), HasSubstr("'setup'"), HasSubstr("'scatter'")));
}

TEST_F(GraphFiles, UnusableFormatIsNamedWithBothSides) {
  const std::string bad = write(
      "bad.json", burley_with(R"("format": ["r8_uint", "r16_uint", "r32_uint"])", R"("format": "rgba16f")"));
  const Outcome outcome = run({"validate", bad});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err, AllOf(HasSubstr(bad + ":"), HasSubstr("'material'"), HasSubstr("rgba16f")));
}

TEST_F(GraphFiles, MissingFileIsNamed) {
  const Outcome outcome = run({"validate", path("none.json")});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err, HasSubstr("none.json"));
}

TEST_F(GraphFiles, AllFilesAreCheckedAfterABadOne) {
  const std::string bad = write("bad.json", "[");
  const Outcome outcome = run({"validate", bad, burley, "--json"});
  EXPECT_EQ(outcome.exit_code, 1);
  ASSERT_TRUE(is_json(outcome.out)) << outcome.out;
  EXPECT_THAT(outcome.out, AllOf(::testing::StartsWith("{\n  \"ok\": false,"),
                                 HasSubstr("burley.json\", \"kind\": \"graph\", \"ok\": true")));
}

TEST_F(GraphFiles, AGraphIsReadFromStandardInput) {
  RunOptions options;
  options.input = "{ \"dermis\": 3 }";
  const Outcome outcome = run({"validate", "-"}, options);
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err, HasSubstr("<stdin>:1:13"));
}

TEST_F(GraphFiles, ExplainShowsEachPassOfThePlan) {
  const Outcome outcome = run({"explain", burley, "--size", "640x360"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  for (const char* pass : {"classify", "list", "setup", "scatter", "combine"})
    EXPECT_THAT(outcome.out, HasSubstr(pass));
  const Outcome json = run({"explain", burley, "--json"});
  EXPECT_EQ(json.exit_code, 0);
  EXPECT_TRUE(is_json(json.out));
}

TEST_F(GraphFiles, ExplainDescribesADiagnosticCode) {
  const Outcome outcome = run({"explain", "D0103"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.out, StartsWith("D0103 unknown_key (error)\n"));
  // From docs/diagnostics.md.
  EXPECT_THAT(outcome.out, HasSubstr("The nearest known key is suggested"));
  for (const char* code : {"d0103", "103", "0103"})
    EXPECT_EQ(run({"explain", code}).out, outcome.out) << code;
  const Outcome unknown = run({"explain", "D0999"});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.err, HasSubstr("there is no message D0999"));
  EXPECT_TRUE(is_json(run({"explain", "D0103", "--json"}).out));
}

TEST_F(GraphFiles, GraphWritesDotAndJson) {
  const Outcome dot = run({"graph", burley});
  EXPECT_EQ(dot.exit_code, 0) << dot.err;
  EXPECT_THAT(dot.out, StartsWith("digraph"));
  const Outcome json = run({"graph", burley, "--json", "--out", path("plan.json")});
  EXPECT_EQ(json.exit_code, 0) << json.err;
  EXPECT_THAT(files(), ::testing::ElementsAre("plan.json"));
}

TEST_F(GraphFiles, UnwritableOutput_IsAnEnvironmentError) {
  const Outcome outcome = run({"graph", burley, "--out", path("no/such/folder.dot")});
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_THAT(outcome.err, HasSubstr("no/such/folder.dot"));
  EXPECT_THAT(files(), IsEmpty());
}

TEST_F(GraphFiles, MessagesAreWrittenAsSarif) {
  const std::string bad = write("bad.json", burley_with("\"imports\"", "\"import\""));
  const Outcome outcome = run({"validate", bad, "--sarif", path("out.sarif")});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err, HasSubstr("D0103"));
  const Outcome log = run({"validate", bad, "--sarif", "-"});
  EXPECT_EQ(log.exit_code, 1);
  ASSERT_TRUE(is_json(log.out)) << log.out;
  std::ifstream stream(path("out.sarif"));
  std::ostringstream text;
  text << stream.rdbuf();
  EXPECT_EQ(text.str(), log.out);
  EXPECT_THAT(log.out, AllOf(HasSubstr("\"ruleId\": \"D0103\""), HasSubstr("\"version\": \"2.1.0\"")));
  const Outcome good = run({"validate", burley, "--sarif", "-"});
  EXPECT_EQ(good.exit_code, 0);
  EXPECT_TRUE(is_json(good.out)) << good.out;
  EXPECT_EQ(run({"validate", burley, "--sarif", "-", "--json"}).exit_code, 2);
  EXPECT_EQ(run({"validate", burley, "--sarif", path("no/such.sarif")}).exit_code, 3);
}

TEST_F(GraphFiles, CaptureIsCheckedAsAFileOrFolder) {
  write_plane(path("capture"));
  for (const std::string& one : {path("capture"), path("capture/frame.json")}) {
    const Outcome outcome = run({"validate", one});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("frame.json: capture, no problems"));
  }
  Plane named;
  named.profiles = R"([{ "id": 1, "file": "skin" }])";
  write_plane(path("named"), named);
  EXPECT_EQ(run({"validate", path("named")}).exit_code, 0);
  const Outcome elsewhere = run({"validate", path("named"), "--profiles", path("capture")});
  EXPECT_EQ(elsewhere.exit_code, 1);
  EXPECT_THAT(elsewhere.err, HasSubstr("profile 'skin' does not exist"));
  write("capture/lighting.exr", "no picture");
  const Outcome broken = run({"validate", path("capture")});
  EXPECT_EQ(broken.exit_code, 1);
  EXPECT_THAT(broken.err, HasSubstr("lighting.exr"));
  const Outcome empty = run({"validate", "docs"});
  EXPECT_EQ(empty.exit_code, 1);
  EXPECT_THAT(empty.err, HasSubstr("holds no frame"));
}

TEST_F(GraphFiles, Upgrade_NewestAndUnknownVersions) {
  const std::string text = burley_with("\"burley\"", "\"mine\"");
  const std::string mine = write("mine.json", text);
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"upgrade", mine}, {"upgrade", "--check", mine}}) {
    const Outcome outcome = run(words);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("graph, version 2 is the newest: nothing to"));
  }
  EXPECT_THAT(files(), ::testing::ElementsAre("mine.json"));
  const std::string newer = write("newer.json", "{ \"dermis_scene\": 7 }");
  const Outcome rejected = run({"upgrade", "--check", newer, mine, "--json"});
  EXPECT_EQ(rejected.exit_code, 1);
  ASSERT_TRUE(is_json(rejected.out));
  EXPECT_THAT(rejected.out, AllOf(HasSubstr("\"kind\": \"scene\", \"version\": null"), HasSubstr("D0110"),
                                  HasSubstr("\"kind\": \"graph\", \"version\": 2, \"changed\": false")));
}

TEST_F(GraphFiles, OverlaysApplyInOrder_ExplainNamesTheirFiles) {
  const std::string first = write("first.json", R"({ "dermis_overlay": 2, "edits": [
    { "set": "/settings/samples/int", "to": 8 }, { "remove": "/passes/export_scattered" },
    { "remove": "/exports/scattered_light" }, { "remove": "/resources/scattered_light" } ] })");
  const std::string second = write("second.json", R"({ "dermis_overlay": 2, "edits": [
    { "set": "/settings/samples/int", "to": 16 } ] })");
  for (const char* verb : {"validate", "explain", "graph"}) {
    const Outcome outcome = run({verb, burley, "--overlay", first, "--overlay", second});
    EXPECT_EQ(outcome.exit_code, 0) << verb << outcome.err;
  }
  const Outcome text = run({"explain", burley, "--overlay", first, "--overlay", second});
  EXPECT_THAT(text.out, AllOf(HasSubstr("remove   /passes/export_scattered  (" + first + ":2:62)"),
                              HasSubstr("set      /settings/samples/int  (" + second + ":2:14)")));
  const Outcome json = run({"explain", burley, "--json", "--overlay", second, "--overlay", first});
  ASSERT_TRUE(is_json(json.out));
  EXPECT_THAT(json.out,
              AllOf(HasSubstr("\"name\": \"samples\", \"type\": \"int\", \"value\": 8"),
                    HasSubstr("{ \"did\": \"set\", \"at\": \"/settings/samples/int\", \"file\": \"" + first +
                              "\", \"line\": 2, \"column\": 14 }")));
}

TEST_F(GraphFiles, OverlayError_IsReportedInTheOverlay) {
  const std::string wrong = write("wrong.json", R"({ "dermis_overlay": 2,
  "edits": [ { "set": "/settings/samples/int", "to": 1 } ] })");
  for (const char* verb : {"validate", "explain", "graph"}) {
    const Outcome outcome = run({verb, burley, "--overlay", wrong});
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_THAT(outcome.err, AllOf(HasSubstr(wrong + ":2:54: error[D0223"), HasSubstr("burley.json:")));
  }
  EXPECT_EQ(run({"validate", wrong}).exit_code, 0) << "without a graph the file is an overlay";
  EXPECT_EQ(run({"validate", wrong, "--overlay", wrong}).exit_code, 2) << "there is no graph";
  const Outcome none = run({"explain", burley, "--overlay", path("none.json")});
  EXPECT_EQ(none.exit_code, 1);
  EXPECT_THAT(none.err, HasSubstr("none.json"));
}

TEST_F(GraphFiles, IncludesAreReadBelowFolderAndRoots) {
  const std::string classify = R"({ "pass": "classify", "type": "subsurface.classify",
      "read": { "material": "material", "depth": "depth", "scatter_scale": "scatter_scale" },
      "write": { "classes": "classes" } })";
  const std::string graph =
      write("graphs/mine.json", burley_with(classify, R"({ "include": "parts/classify.json" })"));
  const Outcome missing = run({"validate", graph});
  EXPECT_EQ(missing.exit_code, 1);
  EXPECT_THAT(missing.err, AllOf(HasSubstr("D0109"), HasSubstr("there is no such file in")));
  write("shared/parts/classify.json", "{ \"dermis_fragment\": 2, \"passes\": [ " + classify + " ] }");
  const Outcome good = run({"validate", graph, "--root", path("shared")});
  EXPECT_EQ(good.exit_code, 0) << good.err;
  const Outcome fragment_outcome = run({"validate", path("shared/parts/classify.json")});
  EXPECT_EQ(fragment_outcome.exit_code, 1) << "the file does not declare its resources";
  EXPECT_THAT(fragment_outcome.err, HasSubstr("classify.json:2:29: error[D0203"));
}

TEST_F(GraphFiles, SceneProfilesAreReadInFolderAndRoots) {
  write("elsewhere/secret.json", "{ \"dermis_profile\": 1 }");
  const std::string scene = write("here/scene.json", R"({ "dermis_scene": 1, "name": "s",
  "profiles": [ { "name": "skin", "file": "../elsewhere/secret.json" } ],
  "camera": { "position": [0, 0, 1], "target": [0, 0, 0], "vertical_fov": 20 },
  "objects": [ { "shape": "sphere", "profile": "skin" } ] })");
  for (const std::vector<std::string>& words : {std::vector<std::string>{"validate", scene},
                                                {"render", scene, "--graph", "none", "--out", path("out")},
                                                {"capture", scene, "--out", path("out")}}) {
    const Outcome outside = run(words);
    EXPECT_EQ(outside.exit_code, 1) << words[0];
    EXPECT_THAT(outside.err, AllOf(HasSubstr("scene.json:2:43: error[D0118"),
                                   HasSubstr("outside the readable folders"), HasSubstr("--root")))
        << words[0];
    EXPECT_FALSE(std::filesystem::exists(path("out"))) << words[0];
  }
  EXPECT_EQ(run({"validate", scene, "--root", path("elsewhere")}).exit_code, 0);
}

} // namespace
} // namespace dermis::test
