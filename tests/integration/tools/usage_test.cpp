// Tests the replies to bad options: exit code 2, the error, and the nearest correct word.

#include "tests/integration/tools/command_fixture.hpp"

namespace dermis::test {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

using Usage = CommandTest;

TEST_F(Usage, HelpOfEveryVerbShowsAnExampleAndSucceeds) {
  for (const std::string verb :
       {"validate", "upgrade", "test", "explain", "graph", "render", "sheet", "apply", "reference"}) {
    const Outcome outcome = run({verb, "--help"});
    EXPECT_EQ(outcome.exit_code, 0) << verb;
    EXPECT_THAT(outcome.out, HasSubstr("Example:\n  dermis " + verb)) << verb;
    EXPECT_THAT(outcome.out, HasSubstr("Usage: dermis " + verb)) << verb;
    EXPECT_THAT(outcome.err, IsEmpty()) << verb;
  }
}

TEST_F(Usage, HelpNamesTheExitCodes) {
  const Outcome outcome = run({"--help"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.out, HasSubstr("Exit codes: 0"));
  EXPECT_THAT(outcome.out, HasSubstr("130 stopped by Ctrl-C"));
}

TEST_F(Usage, NoVerbIsAUsageError) {
  EXPECT_EQ(run({}).exit_code, 2);
}

TEST_F(Usage, MisspeltVerb_SuggestsTheNearest) {
  const Outcome outcome = run({"rendr"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("no verb 'rendr'; did you mean 'render'?"));
  const Outcome suite = run({"bench", "stabilty"});
  EXPECT_EQ(suite.exit_code, 2);
  EXPECT_THAT(suite.err, HasSubstr("no verb of 'bench' 'stabilty'; did you mean 'stability'?"));
}

TEST_F(Usage, MisspeltOption_SuggestsTheNearestFirst) {
  const Outcome outcome = run({"apply", "--grph", burley});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("'apply' has no option '--grph'; did you mean '--graph'?"));
}

TEST_F(Usage, AMissingRequiredOptionIsNamed) {
  const Outcome outcome = run({"apply", "--graph", burley, "--frames", "capture"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("--out"));
}

TEST_F(Usage, InvalidSize_WritesNothing) {
  for (const std::string size :
       {"0x0", "0x360", "640", "640x", "x360", "640x360x3", "-1x5", "16385x10", "1e3x10"}) {
    const Outcome outcome =
        run({"render", "configs/scenes/bust.json", "--graph", burley, "--size", size, "--out", path("out")});
    EXPECT_EQ(outcome.exit_code, 2) << size;
    EXPECT_THAT(outcome.err, HasSubstr("640x360, each 1..16384, found '" + size + "'"));
    EXPECT_THAT(files(), IsEmpty()) << size;
  }
}

TEST_F(Usage, UnknownSetting_SuggestsTheNearest) {
  const Outcome outcome = run({"explain", burley, "--set", "sample=16"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("no setting 'sample'; did you mean 'samples'?"));
}

TEST_F(Usage, SettingOutOfRangeOrOfWrongType_IsRejected) {
  const Outcome range = run({"explain", burley, "--set", "samples=1"});
  EXPECT_EQ(range.exit_code, 2);
  EXPECT_THAT(range.err, HasSubstr("setting 'samples': 1 is outside 4 .. 4096"));
  const Outcome type = run({"explain", burley, "--set", "samples=many"});
  EXPECT_EQ(type.exit_code, 2);
  EXPECT_THAT(type.err, HasSubstr("expected an integer, found 'many'"));
  const Outcome word = run({"explain", burley, "--set", "texturing=posst"});
  EXPECT_EQ(word.exit_code, 2);
  EXPECT_THAT(word.err, HasSubstr("'post', 'pre_post', 'pre' or 'demodulate'"));
}

TEST_F(Usage, RequiredSlotCannotBeUnbound) {
  const Outcome outcome = run({"explain", burley, "--unbound", "depth"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("'depth' is not optional"));
}

TEST_F(Usage, UsageErrorIsOneJsonDocument) {
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"rendr", "--json"}, {"explain", burley, "--json", "--set", "sample=1"}}) {
    const Outcome outcome = run(words);
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_TRUE(is_json(outcome.out)) << outcome.out;
    EXPECT_THAT(outcome.out, HasSubstr("\"exit_code\": 2"));
    EXPECT_THAT(outcome.err, IsEmpty());
  }
}

TEST_F(Usage, ColourIsUsedOnRequestAndNeverInFiles) {
  const std::string bad = write("bad.json", "{ \"dermis\": 2, }");
  EXPECT_THAT(run({"validate", bad, "--color", "always"}).err, HasSubstr("\x1b["));
  EXPECT_THAT(run({"validate", bad}).err, Not(HasSubstr("\x1b[")));
  EXPECT_EQ(run({"validate", bad, "--color", "sometimes"}).exit_code, 2);
}

TEST_F(Usage, SchemasArePrintedOneByOneOrWrittenTogether) {
  for (const char* name :
       {"graph", "fragment", "overlay", "expectation", "profile", "scene", "capture", "plan"}) {
    const Outcome outcome = run({"schema", name});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_TRUE(is_json(outcome.out)) << name;
  }
  EXPECT_EQ(run({"schema", "--out", path("schemas")}).exit_code, 0);
  EXPECT_THAT(files("schemas"), ::testing::Contains(HasSubstr("graph.schema.json")));
  const Outcome unknown = run({"schema", "grahp"});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.err, HasSubstr("did you mean 'graph'?"));
  EXPECT_EQ(run({"schema"}).exit_code, 2);
}

} // namespace
} // namespace dermis::test
