// validate, explain and graph: good files answer well; each wrong one says where, what and what to do.

#include "tests/command/command_fixture.hpp"

#include <fmt/format.h>

#include <fstream>
#include <sstream>

namespace dermis::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

using GraphFiles = CommandTest;

constexpr const char* burley = "configs/graphs/burley.json";

// The shipped graph with one piece of its text replaced.
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
    for (const auto& entry :
         std::filesystem::directory_iterator(fmt::format("{}/configs/{}", DERMIS_SOURCE_DIR, folder)))
      words.push_back(entry.path().string());
  const Outcome outcome = run(words);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("burley.json: graph, no problems"));
  EXPECT_THAT(outcome.out, HasSubstr("burley.expect.json: expectations, no problems"));
  EXPECT_THAT(outcome.out, HasSubstr("skin.json: profile, no problems"));
  EXPECT_THAT(outcome.out, HasSubstr("bust.json: scene, no problems"));
}

TEST_F(GraphFiles, MalformedJsonIsNamedWithFileLineAndColumn) {
  const std::string bad = write("bad.json", "{ \"dermis\": 1,\n  \"name\": }\n");
  const Outcome outcome = run({"validate", bad});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err, AllOf(HasSubstr(bad + ":2:11: error[D0101 syntax]"), HasSubstr("^")));
  EXPECT_THAT(outcome.out, IsEmpty());
}

TEST_F(GraphFiles, AnUnknownKeyIsAnsweredWithTheNearestOne) {
  const std::string bad = write("bad.json", burley_with("\"imports\"", "\"import\""));
  const Outcome outcome = run({"validate", bad});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("D0103"), HasSubstr("did you mean 'imports'?")));
}

TEST_F(GraphFiles, AMissingImportIsNamedWithThePassThatReadsIt) {
  const std::string bad =
      write("bad.json", burley_with("\"depth\": { \"format\": \"depth\", \"size\": \"view\" },", ""));
  const Outcome outcome = run({"validate", bad});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err, AllOf(HasSubstr(bad + ":"), HasSubstr("'depth'"), HasSubstr("'classify'")));
}

TEST_F(GraphFiles, ACycleNamesThePassesOnIt) {
  // `setup` wants what `scatter` makes, and the other way round.
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

TEST_F(GraphFiles, AFormatThatNoPortCanUseIsNamedWithBothSides) {
  const std::string bad = write("bad.json", burley_with("\"material\": { \"format\": \"r8_uint\"",
                                                        "\"material\": { \"format\": \"rgba16f\""));
  const Outcome outcome = run({"validate", bad});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err, AllOf(HasSubstr(bad + ":"), HasSubstr("'material'"), HasSubstr("rgba16f")));
}

TEST_F(GraphFiles, AFileThatIsNotThereIsNamed) {
  const Outcome outcome = run({"validate", path("none.json")});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err, HasSubstr("none.json"));
}

TEST_F(GraphFiles, AllFilesAreCheckedEvenAfterABadOne) {
  const std::string bad = write("bad.json", "[");
  const Outcome outcome = run({"validate", bad, burley, "--json"});
  EXPECT_EQ(outcome.exit_code, 1);
  ASSERT_TRUE(is_json(outcome.out)) << outcome.out;
  EXPECT_THAT(outcome.out, AllOf(testing::StartsWith("{\n  \"ok\": false,"),
                                 HasSubstr("burley.json\", \"kind\": \"graph\", \"ok\": true")));
}

TEST_F(GraphFiles, AGraphIsReadFromStandardInput) {
  RunOptions options;
  options.input = "{ \"dermis\": 2 }";
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

TEST_F(GraphFiles, ExplainSaysWhatACodeMeans) {
  const Outcome outcome = run({"explain", "D0103"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.out, StartsWith("D0103 unknown_key (error)\n"));
  EXPECT_TRUE(is_json(run({"explain", "D0103", "--json"}).out));
}

TEST_F(GraphFiles, GraphWritesDotAndJson) {
  const Outcome dot = run({"graph", burley});
  EXPECT_EQ(dot.exit_code, 0) << dot.err;
  EXPECT_THAT(dot.out, StartsWith("digraph"));
  const Outcome json = run({"graph", burley, "--json", "--out", path("plan.json")});
  EXPECT_EQ(json.exit_code, 0) << json.err;
  EXPECT_THAT(files(), testing::ElementsAre("plan.json"));
}

TEST_F(GraphFiles, AnOutputThatCannotBeWrittenIsAnEnvironmentErrorAndLeavesNothing) {
  const Outcome outcome = run({"graph", burley, "--out", path("no/such/folder.dot")});
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_THAT(outcome.err, HasSubstr("no/such/folder.dot"));
  EXPECT_THAT(files(), IsEmpty());
}

} // namespace
} // namespace dermis::test
