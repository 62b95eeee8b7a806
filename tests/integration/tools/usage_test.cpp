// Tests the replies to bad options: exit code 2, the error, and the nearest correct word.

#include "tests/integration/tools/command_fixture.hpp"

#include <sys/stat.h>

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
  const std::string help = run({"--help"}).out, page = run({"man"}).out;
  const std::string documented = read_text("docs/tools.md");
  for (const char* code : {"0", "1", "2", "3", "4", "130", "141"}) {
    EXPECT_THAT(help.substr(help.find("Exit codes:")),
                ::testing::ContainsRegex(std::string("[:;][ \n]") + code + " "));
    EXPECT_THAT(page, HasSubstr(std::string(".TP\n") + code + "\n"));
    EXPECT_THAT(documented, HasSubstr(std::string("| ") + code + " | "));
  }
}

TEST_F(Usage, MissingVerb_SaysWhereVerbsAreListed) {
  EXPECT_THAT(run({}), FailsWith(2, "a verb is required; 'dermis --help' lists all verbs"));
  EXPECT_THAT(run({"plan"}), FailsWith(2, "'plan' requires a verb: 'diff', 'save' or 'verify'; "
                                          "'dermis plan --help' describes them"));
}

TEST_F(Usage, MisspeltVerb_SuggestsTheNearest) {
  EXPECT_THAT(run({"rendr"}), FailsWith(2, "no verb 'rendr'; did you mean 'render'?"));
  EXPECT_THAT(run({"bench", "stabilty"}),
              FailsWith(2, "'bench' has no verb 'stabilty'; did you mean 'stability'?"));
}

TEST_F(Usage, MisspeltOption_SuggestsTheNearestFirst) {
  EXPECT_THAT(run({"apply", "--grph", burley}),
              FailsWith(2, "'apply' has no option '--grph'; did you mean '--graph'?"));
  EXPECT_THAT(run({"render", "--nope"}),
              FailsWith(2, "'render' has no option '--nope'; 'dermis render --help' lists them"));
  EXPECT_THAT(run({"bench", "record", "--out", "x"}),
              FailsWith(2, "'bench record' has no option '--out'; 'dermis bench record --help'"));
}

TEST_F(Usage, AMissingRequiredOptionIsNamed) {
  EXPECT_THAT(run({"apply", "--graph", burley, "--frames", "capture"}), FailsWith(2, "--out"));
}

TEST_F(Usage, WrongValue_StatesWhatIsExpected) {
  struct Case {
    std::vector<std::string> words;
    const char* message;
  };
  const std::vector<std::string> render{"render", "scene.json", "--graph", burley};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), render.begin(), render.end());
    return more;
  };
  const Case cases[] = {
      {render, "--out is required; 'dermis render --help' describes it"},
      {{"compare", "a.png"}, "argument 'b' is required; 'dermis compare --help' describes it"},
      {with({"--frames", "0"}), "--frames: expected a number from 1 to 100000, found '0'"},
      {with({"--budget", "-1"}), "--budget: expected a number from 0 to 1000000, found '-1'"},
      {with({"--budget", "nan"}), "--budget: expected a number from 0 to 1000000, found 'nan'"},
      {{"compare", "a.png", "b.png", "--flip", "--pixels-per-degree", "nan"},
       "--pixels-per-degree: expected a number from 1 to 1000, found 'nan'"},
      {{"kernels", "--limits", ""}, "--limits: the value is empty; 'dermis kernels --help'"},
      {{"validate", ""}, "files: the value is empty; 'dermis validate --help'"},
      {with({"--out", "o", "--height", "1"}), "--height requires --model"},
      {with({"--shaders", "none"}), "--shaders: there is no folder 'none'"},
      {with({"--kernels", "fpga"}), "--kernels: expected 'cpu', 'device', 'gpu' or 'gpu_small', "
                                    "found 'fpga'"},
      {with({"--frames"}), "--frames: the value is missing; 'dermis render --help' describes it"},
      {with({"--out", "a", "--out", "b"}), "--out may be given only once"},
      {with({"--set", "samples", "64"}), "--set: expected NAME=VALUE such as samples=16, found "
                                         "'samples'"},
      {with({"--out", "o", "--trials", "never"}), "--trials requires --budget"},
      {with({"--out", "o", "--budget-percentile", "0.9"}), "--budget-percentile requires --budget"},
      {{"render", "configs/scenes/bust.json", "--graph", "none", "--debug", "samples", "--out",
        "o"},
       "--debug, --budget, --calibration and --errors need a graph"},
      {{"explain", burley, "--frame", "--two-queues"}, "--two-queues excludes --frame"},
      {{"bench", "error-time", "--family", "--size", "64x64"}, "--size excludes --family"},
      {{"watch", "scene.json", "--graph", "-", "--out", "o"},
       "standard input does not change; name a graph file to watch"},
      {{"bench", "all", "--out", "a", "more"},
       "unexpected argument 'more'; 'dermis bench all --help' lists the arguments"},
  };
  for (const Case& one : cases)
    EXPECT_THAT(run(one.words), FailsWith(2, one.message)) << one.message;
}

TEST_F(Usage, OutputThatIsAnInput_IsRejectedAndKept) {
  const std::string text = read_text(burley), graph = write("my.json", text);
  const std::string picture = write("a.png", "not a picture");
  std::filesystem::create_symlink(graph, path("link.json"));
  const std::vector<std::string> commands[] = {
      {"explain", graph, "-o", graph},
      {"explain", graph, "-o", path("link.json")},
      {"graph", graph, "--html", graph},
      {"validate", graph, "--sarif", graph},
      {"plan", "save", graph, "-o", graph},
      {"calibrate", graph, "-o", graph},
      {"render", "scene.json", "-g", graph, "-o", path("out"), "--trace", graph},
      {"sheet", graph, "-o", graph},
      {"compare", picture, picture, "--heat", picture},
  };
  for (const std::vector<std::string>& words : commands)
    EXPECT_THAT(run(words), FailsWith(2, "is an input of this command; choose another file"))
        << ::testing::PrintToString(words);
  EXPECT_TRUE(read("my.json") == text);
  EXPECT_EQ(read("a.png"), "not a picture");
}

TEST_F(Usage, OutputsThatOverlap_AreRejected) {
  EXPECT_THAT(run({"compare", "a.png", "b.png", "--heat", path("x.png"), "--flip", "--flip-map",
                   path("./x.png")}),
              FailsWith(2, "--heat and --flip-map overlap"));
  for (const char* capture : {"o", "o/in", "./o/"}) {
    EXPECT_THAT(
        run({"render", "scene.json", "-g", burley, "--out", path("o"), "--capture", path(capture)}),
        FailsWith(2, "--out and --capture overlap"))
        << capture;
  }
  EXPECT_THAT(run({"render", "no_scene.json", "-g", burley, "--out", path("o"), "--trace",
                   path("o/trace.json")}),
              FailsWith(1, "no_scene.json"));
}

TEST_F(Usage, EmptyEntryOfAList_IsRejected) {
  for (const char* list : {",", ",,", "a.json,", ",a.json", "a.json,,b.json"})
    EXPECT_THAT(run({"sheet", "-o", path("x.png"), "--graphs", list, "--size", "16x16"}),
                FailsWith(2, std::string("--graphs: the list '") + list + "' has an empty entry"));
  EXPECT_THAT(run({"sheet", "-o", path("x.png"), "--budgets=1,"}),
              FailsWith(2, "--budgets: the list '1,' has an empty entry"));
}

TEST_F(Usage, FolderThatDoesNotExist_IsNamed) {
  EXPECT_THAT(run({"explain", burley, "--root", "none"}),
              FailsWith(2, "--root: there is no folder 'none'"));
  EXPECT_THAT(run({"apply", "-g", burley, "--frames", ".", "-o", path("o"), "--profiles", "none"}),
              FailsWith(2, "--profiles: there is no folder 'none'"));
  EXPECT_THAT(run({"docs", "--graphs", "none", "-o", path("docs")}),
              FailsWith(2, "--graphs: there is no folder 'none'"));
}

TEST_F(Usage, PipeIsNotRead) {
  ASSERT_EQ(::mkfifo(path("pipe").c_str(), 0600), 0);
  EXPECT_THAT(run({"validate", path("pipe")}), FailsWith(1, "not a regular file"));
  EXPECT_THAT(run({"plan", "diff", path("pipe"), burley}), FailsWith(1, "not a regular file"));
}

TEST_F(Usage, UnwritableFile_IsReportedBeforeTheWork) {
  const std::string below_a_file = write("file", "") + "/x.json";
  EXPECT_THAT(run({"render", "configs/scenes/bust.json", "-g", burley, "--size", "16x16", "-o",
                   path("o"), "--trace", below_a_file}),
              FailsWith(3, "output folder"));
  EXPECT_THAT(files(), ElementsAre("file"));
  EXPECT_THAT(run({"calibrate", burley, "-o", below_a_file}), FailsWith(3, "output folder"));
  EXPECT_THAT(run({"test", "configs/graphs", "--junit", below_a_file}),
              FailsWith(3, "output folder"));
}

TEST_F(Usage, ChoiceWithoutAGraph_IsRejected) {
  EXPECT_THAT(
      run({"render", "configs/scenes/bust.json", "-g", "none", "--budget", "5", "-o", path("o")}),
      FailsWith(2, "need a graph"));
}

TEST_F(Usage, MissingGraphFile_SuggestsAShippedGraph) {
  EXPECT_THAT(run({"explain", "burley"}),
              FailsWith(1, "did you mean 'configs/graphs/burley.json'?"));
  EXPECT_THAT(run({"explain", "graphs/sap_blent.json"}),
              FailsWith(1, "did you mean 'configs/graphs/papers/sap_blend.json'?"));
  EXPECT_THAT(run({"explain", "a_graph_of_mine.json"}).err, Not(HasSubstr("did you mean")));
  EXPECT_THAT(run({"test", burley}),
              FailsWith(1, "expected a folder or a file NAME.expect.json next to the graph"));
}

TEST_F(Usage, NamesThatAreNotUtf8_GiveValidJson) {
  const Outcome outcome = run({"validate", "no\xff.json", "--json"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("no\xef\xbf\xbd.json"), Not(HasSubstr("no\xff"))));
}

TEST_F(Usage, ControlCharactersOfFiles_DoNotReachTheTerminal) {
  const std::string profile = write("p.json", R"({ "dermis_profile": 1, "name": "\u001b[31mred",
    "source": "s", "dmfp_mm": [1, 1, 1], "albedo": [0.5, 0.5, 0.5] })");
  EXPECT_THAT(run({"validate", profile}), Succeeds("\\x1b[31mred"));
}

TEST_F(Usage, EmptyTable_IsAnError) {
  const std::string empty = write("empty.json", "");
  for (const char* option : {"--calibration", "--errors"})
    EXPECT_THAT(run({"explain", "configs/graphs/skin.json", "--choices", option, empty}),
                FailsWith(1, "is empty"));
  EXPECT_THAT(run({"bench", "compile", "--quick", "--graphs", path("none")}),
              FailsWith(1, "has no graph files"));
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

TEST_F(Usage, ResultThatCannotBeWritten_IsAFailure) {
  const std::string full = "/dev/full"; // has no space
  if (!std::filesystem::exists(full)) GTEST_SKIP() << "there is no " << full;
  for (const std::vector<std::string>& command :
       {std::vector<std::string>{"validate", burley, "--json"}, {"explain", burley}, {"--help"}}) {
    const Outcome outcome = run(command, {.output = full});
    EXPECT_EQ(outcome.exit_code, 3) << command.front();
    EXPECT_THAT(outcome.err, HasSubstr("standard output")) << command.front();
  }
}

TEST_F(Usage, SchemasArePrintedOneByOneOrWrittenTogether) {
  for (const char* name :
       {"graph", "fragment", "overlay", "expectation", "profile", "scene", "capture", "plan"}) {
    EXPECT_THAT(run({"schema", name}), Succeeds(IsJson())) << name;
  }
  EXPECT_EQ(run({"schema", "--out", path("schemas")}).exit_code, 0);
  EXPECT_THAT(files("schemas"), Contains(HasSubstr("graph.schema.json")));
  const Outcome listed = run({"schema", "--out", path("schemas"), "--json"});
  EXPECT_EQ(listed.exit_code, 0);
  EXPECT_THAT(listed.out, AllOf(IsJson(), HasSubstr("graph.schema.json")));
  EXPECT_THAT(run({"schema", "grahp"}), FailsWith(2, "did you mean 'graph'?"));
  EXPECT_EQ(run({"schema"}).exit_code, 2);
}

} // namespace
} // namespace dermis::test
