// Tests `dermis test`: graphs are compared with their expectation files; changes are shown, and
// written on request.

#include "tests/integration/tools/command_fixture.hpp"

#include <filesystem>

namespace dermis::test {
namespace {

struct Expectations : CommandTest {
  // Writes the shipped burley.json into the test's folder, with these expectations next to it.
  std::string file_next_to_burley(const std::string& expectations) const {
    write("burley.json", read_text(DERMIS_SOURCE_DIR "/configs/graphs/burley.json"));
    return write("burley.expect.json", expectations);
  }
};

constexpr const char* two_infos = R"({ "dermis_expect": 1, "cases": [
  // what the smallest host gets
  { "case": "least", "size": [64, 64], "unbound": ["albedo", "scatter_scale", "scattered_light"],
    "expect": { "passes": ["classify", "list", "setup", "scatter", "combine"], "history_bytes": 0 } } ] }
)";

TEST_F(Expectations, EveryShippedGraphMeetsItsExpectations) {
  size_t graphs = 0;
  for (const auto& entry :
       std::filesystem::recursive_directory_iterator(DERMIS_SOURCE_DIR "/configs/graphs")) {
    const std::string name = entry.path().string();
    if (!name.ends_with(".json") || name.ends_with(".expect.json")) continue;
    ++graphs;
    EXPECT_TRUE(std::filesystem::exists(name.substr(0, name.size() - 5) + ".expect.json")) << name;
  }
  EXPECT_GE(graphs, 2u);
  EXPECT_THAT(run({"test", "configs/"}),
              Succeeds("configs/graphs/burley.expect.json: 6 cases as expected"));
  EXPECT_THAT(run({"test", "configs/graphs"}), Succeeds())
      << "overlays are located next to the folder of graphs\n";
}

TEST_F(Expectations, OnlyStatedFactsAreCompared) {
  file_next_to_burley(two_infos);
  EXPECT_THAT(run({"test", path("")}), Succeeds("burley.expect.json: 1 case as expected"));
}

TEST_F(Expectations, DifferencesAreShownLineByLine) {
  const std::string wrong = replaced(two_infos, "\"scatter\", ", "\"sharpen\", ");
  const std::string file = file_next_to_burley(wrong);
  const Outcome outcome = run({"test", file});
  EXPECT_THAT(outcome, FailsWith(1, file + ": case 'least'", "-     \"sharpen\"",
                                 "+     \"scatter\"", "      \"setup\"", "--update"));
  EXPECT_THAT(outcome.out, IsEmpty());
  EXPECT_EQ(read_text(file), wrong);
}

TEST_F(Expectations, UpdateChangesOnlyTheFacts) {
  const std::string wrong = replaced(two_infos, "\"history_bytes\": 0", "\"history_bytes\": 5");
  const std::string file = file_next_to_burley(wrong);
  EXPECT_EQ(run({"test", file, "--update"}).exit_code, 0);
  const std::string after = read_text(file);
  EXPECT_THAT(after,
              AllOf(HasSubstr("// what the smallest host gets"), HasSubstr("\"history_bytes\": 0"),
                    HasSubstr("\"size\": [64, 64]"), Not(HasSubstr("barriers"))));
  EXPECT_EQ(run({"test", file}).exit_code, 0);
  EXPECT_EQ(run({"test", file, "--update"}).exit_code, 0);
  EXPECT_EQ(read_text(file), after);
}

// A carriage return ends a comment, too.
TEST_F(Expectations, UpdateKeepsWhatFollowsAComment) {
  const std::string file =
      file_next_to_burley("{ \"dermis_expect\": 1, \"cases\": [ { \"case\": "
                          "\"a\", \"expect\": {//x\r\"passes\": [\"old\"]}}]}");
  EXPECT_EQ(run({"test", file, "--update"}).exit_code, 0);
  EXPECT_EQ(run({"test", file}).exit_code, 0) << read_text(file);
}

TEST_F(Expectations, UpdateOfAnEmptyCaseStatesEverything) {
  const std::string file = file_next_to_burley(R"({ "dermis_expect": 1, "cases": [
  { "case": "new" },
  { "case": "too_large", "device": { "max_image_dimension": 16 } } ] })");
  EXPECT_THAT(run({"test", file}), FailsWith(1, "case 'new': the case has no \"expect\""));
  EXPECT_THAT(run({"test", file, "--update"}), Succeeds());
  EXPECT_THAT(read_text(file), HasAll("\"transient_bytes\"", "\"diagnostics\""));
  EXPECT_EQ(run({"test", file}).exit_code, 0) << read_text(file);
}

TEST_F(Expectations, UnstatedMessagesAreShown) {
  const std::string file = file_next_to_burley(R"({ "dermis_expect": 1, "cases": [
  { "case": "small", "device": { "max_image_dimension": 16 }, "expect": {} } ] })");
  EXPECT_THAT(run({"test", file}), FailsWith(1, "+   \"diagnostics\": [", "error[D03"));
}

TEST_F(Expectations, UnreadableGraph_HasOnlyMessages) {
  const std::string file = write("bad.expect.json", R"({ "dermis_expect": 1, "cases": [
  { "case": "syntax", "expect": { "diagnostics": ["D0101"] } } ] })");
  write("bad.json", "{ \"dermis\": 2,\n \"name\": }");
  EXPECT_EQ(run({"test", file}).exit_code, 0);
}

TEST_F(Expectations, UnknownNamesAreReported) {
  const auto says = [&](const std::string& inputs, const std::string& message) {
    const std::string file =
        file_next_to_burley("{ \"dermis_expect\": 1, \"cases\": [ { \"case\": \"a\", " + inputs +
                            ", \"expect\": {} } ] }");
    for (const char* flag : {"--quiet", "--update"}) {
      EXPECT_THAT(run({"test", file, flag}), FailsWith(1, message)) << inputs;
    }
  };
  says(R"("set": { "sample": 8 })", "no setting 'sample'; did you mean 'samples'?");
  says(R"("set": { "samples": 1 })", "1 is outside 4 .. 4096");
  says(R"("unbound": ["depth"])", "'depth' is not optional");
  says(R"("host_formats": { "light_in": "rgba32f" })", "no resource 'light_in'");
}

TEST_F(Expectations, ErrorsInTheFileAreLocated) {
  const auto says = [&](const std::string& text, const std::string& message) {
    const std::string file = file_next_to_burley(text);
    EXPECT_THAT(run({"test", file}), FailsWith(1, file + ":", message)) << text;
  };
  says(R"({ "dermis_expect": 2, "cases": [] })", ":1:20: error[D0110");
  says(R"({ "dermis_expect": 1, "cases": [] })", "D01");
  says(R"({ "dermis_expect": 1, "cases": [ { "case": "a", "expects": {} } ] })",
       "did you mean 'expect'?");
  says(R"({ "dermis_expect": 1, "cases": [ { "case": "a", "device": { "lacks": ["rays"] } } ] })",
       "there is no feature 'rays'");
  says(R"({ "dermis_expect": 1, "cases": [ { "case": "a" }, { "case": "a" } ] })",
       "two cases are called 'a'");
  says(R"({ "dermis_expect": 1, "cases": [ { "case": "a", "size": [0, 4] } ] })", "D0106");
  says(R"({ "dermis_expect": 1, "cases": [ { "case": "a", "set": { "samples": [] } } ] })",
       "D0112");
  says(
      R"({ "dermis_expect": 1, "cases": [ { "case": "a", "host_formats": { "lighting": "rgb" } } ] })",
      "there is no format 'rgb'");
  says(R"({ "dermis_expect": 1, "cases": [ { "case": "a", "expect": { "passes": [1] } } ] })",
       "D0104");
}

TEST_F(Expectations, NothingToCompare_IsAFailure) {
  EXPECT_EQ(run({"test", path("")}).exit_code, 1);
  EXPECT_EQ(run({"test", path("none.expect.json")}).exit_code, 1);
  EXPECT_EQ(run({"test", "configs/graphs/burley.json"}).exit_code, 1);
  EXPECT_EQ(run({"test"}).exit_code, 2);
  const std::string lonely =
      write("lonely.expect.json", R"({ "dermis_expect": 1, "cases": [ { "case": "a" } ] })");
  EXPECT_THAT(run({"test", lonely, "--update"}),
              FailsWith(1, "next to the expectation file does not exist"));
}

TEST_F(Expectations, ResultsAreWrittenAsJUnitAndJson) {
  const std::string wrong = replaced(replaced(two_infos, "\"least\"", "\"a<b & c\""),
                                     "\"history_bytes\": 0", "\"history_bytes\": 5");
  const std::string file = file_next_to_burley(wrong);
  const Outcome outcome = run({"test", file, "configs", "--junit", path("results.xml"), "--json"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_TRUE(is_json(outcome.out)) << outcome.out;
  EXPECT_THAT(outcome.out, StartsWith("{\n  \"ok\": false,"));
  EXPECT_THAT(read_text(path("results.xml")),
              AllOf(StartsWith("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites"),
                    HasSubstr("failures=\"1\""), HasSubstr("name=\"a&lt;b &amp; c\""),
                    HasSubstr("&quot;history_bytes&quot;: 5"), HasSubstr("burley.expect.json")));
  EXPECT_THAT(run({"test", file, "--junit", path("new/folder/results.xml")}), FailsWith(1));
  EXPECT_FALSE(read("new/folder/results.xml").empty());
  EXPECT_THAT(run({"test", "configs", "--junit", write("file", "") + "/results.xml"}),
              FailsWith(3));
}

TEST_F(Expectations, OverlaysComeOnlyFromDeclaredFolders) {
  const std::string file = file_next_to_burley(R"({ "dermis_expect": 1, "cases": [
  { "case": "changed", "overlays": ["changes/less.json"], "unbound": ["scattered_light"],
    "expect": { "passes": ["classify", "list", "setup", "scatter"] } } ] })");
  std::filesystem::create_directories(path("other/changes"));
  const std::string overlay = R"({ "dermis_overlay": 2, "edits": [ { "remove": "/passes/combine" },
    { "set": "/passes/scatter/write/scattered", "to": "lighting" } ] })";
  write("other/changes/less.json", overlay);
  EXPECT_THAT(run({"test", file}),
              FailsWith(1, "overlay 'changes/less.json': there is no such file in",
                        "add folders with --root"));
  const Outcome declared = run({"test", file, "--root", path("other")});
  EXPECT_THAT(declared.err, Not(HasSubstr("no such file")));
  std::filesystem::create_directories(path("changes"));
  std::filesystem::create_symlink(path("other/changes/less.json"), path("changes/less.json"));
  EXPECT_EQ(run({"test", file}).exit_code, declared.exit_code) << "a link inside of the folder";
  std::filesystem::remove(path("changes/less.json"));
  std::filesystem::create_symlink(DERMIS_SOURCE_DIR "/configs/overlays/full_precision.json",
                                  path("changes/less.json"));
  EXPECT_THAT(run({"test", file}), FailsWith(1, "outside the readable folders"));
  const std::string escaping = file_next_to_burley(
      R"({ "dermis_expect": 1, "cases": [ { "case": "a", "overlays": ["../x.json"] } ] })");
  EXPECT_THAT(run({"test", escaping}).err, HasAll(escaping + ":1:", "D0115"));
}

} // namespace
} // namespace dermis::test
