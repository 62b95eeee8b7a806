// Tests the replies to bad options: exit code 2, the error, and the nearest correct word.

#include "tests/integration/tools/command_fixture.hpp"

namespace dermis::test {
namespace {

using Usage = CommandTest;

TEST_F(Usage, HelpOfEveryVerbShowsAnExampleAndSucceeds) {
  for (const std::string verb : {"validate", "upgrade", "test", "explain", "graph", "render",
                                 "sheet", "apply", "reference"}) {
    const Outcome outcome = run({verb, "--help"});
    EXPECT_THAT(outcome, Succeeds("Example:\n  dermis " + verb, "Usage: dermis " + verb)) << verb;
    EXPECT_THAT(outcome.err, IsEmpty()) << verb;
  }
}

TEST_F(Usage, HelpNamesTheExitCodes) {
  EXPECT_THAT(run({"--help"}), Succeeds("Exit codes: 0", "130 stopped by Ctrl-C"));
}

TEST_F(Usage, NoVerbIsAUsageError) {
  EXPECT_EQ(run({}).exit_code, 2);
}

TEST_F(Usage, MisspeltVerb_SuggestsTheNearest) {
  EXPECT_THAT(run({"rendr"}), FailsWith(2, "no verb 'rendr'; did you mean 'render'?"));
  EXPECT_THAT(run({"bench", "stabilty"}),
              FailsWith(2, "no verb of 'bench' 'stabilty'; did you mean 'stability'?"));
}

TEST_F(Usage, MisspeltOption_SuggestsTheNearestFirst) {
  EXPECT_THAT(run({"apply", "--grph", burley}),
              FailsWith(2, "'apply' has no option '--grph'; did you mean '--graph'?"));
}

TEST_F(Usage, AMissingRequiredOptionIsNamed) {
  EXPECT_THAT(run({"apply", "--graph", burley, "--frames", "capture"}), FailsWith(2, "--out"));
}

TEST_F(Usage, InvalidSize_WritesNothing) {
  for (const std::string size :
       {"0x0", "0x360", "640", "640x", "x360", "640x360x3", "-1x5", "16385x10", "1e3x10"}) {
    EXPECT_THAT(run({"render", "configs/scenes/bust.json", "--graph", burley, "--size", size,
                     "--out", path("out")}),
                FailsWith(2, "640x360, each 1..16384, found '" + size + "'"))
        << size;
    EXPECT_THAT(files(), IsEmpty()) << size;
  }
}

TEST_F(Usage, UnknownSetting_SuggestsTheNearest) {
  EXPECT_THAT(run({"explain", burley, "--set", "sample=16"}),
              FailsWith(2, "no setting 'sample'; did you mean 'samples'?"));
}

TEST_F(Usage, SettingOutOfRangeOrOfWrongType_IsRejected) {
  EXPECT_THAT(run({"explain", burley, "--set", "samples=1"}),
              FailsWith(2, "setting 'samples': 1 is outside 4 .. 4096"));
  EXPECT_THAT(run({"explain", burley, "--set", "samples=many"}),
              FailsWith(2, "expected an integer, found 'many'"));
  EXPECT_THAT(run({"explain", burley, "--set", "texturing=posst"}),
              FailsWith(2, "'post', 'pre_post', 'pre' or 'demodulate'"));
}

TEST_F(Usage, RequiredSlotCannotBeUnbound) {
  EXPECT_THAT(run({"explain", burley, "--unbound", "depth"}),
              FailsWith(2, "'depth' is not optional"));
}

TEST_F(Usage, UsageErrorIsOneJsonDocument) {
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"rendr", "--json"},
        {"explain", burley, "--json", "--set", "sample=1"}}) {
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
    EXPECT_THAT(run({"schema", name}), Succeeds(IsJson())) << name;
  }
  EXPECT_EQ(run({"schema", "--out", path("schemas")}).exit_code, 0);
  EXPECT_THAT(files("schemas"), Contains(HasSubstr("graph.schema.json")));
  EXPECT_THAT(run({"schema", "grahp"}), FailsWith(2, "did you mean 'graph'?"));
  EXPECT_EQ(run({"schema"}).exit_code, 2);
}

} // namespace
} // namespace dermis::test
