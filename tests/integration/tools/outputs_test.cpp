// Tests that outputs replace files of earlier runs, and no other files.

#include "tests/integration/tools/command_fixture.hpp"

#include <map>

namespace dermis::test {
namespace {

using Outputs = CommandTest;
using Words = std::vector<std::string>;

constexpr const char* scene = "configs/scenes/bust.json";

Words joined(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

// A tiny rendering into a folder.
Words rendering(const std::string& out) {
  return {"render",   scene, "-g",       burley, "--size", "16x16",
          "--frames", "2",   "--subset", "0",    "--out",  out};
}

TEST_F(Outputs, FileOfAnotherKind_IsRejectedAndKept) {
  const std::string mine = write("mine.json", "{ \"mine\": 1 }");
  const Words commands[] = {
      {"explain", burley, "-o", mine},
      {"graph", burley, "-o", mine},
      {"graph", burley, "--html", mine},
      {"plan", "save", burley, "-o", mine},
      {"schema", "graph", "-o", mine},
      {"man", "-o", mine},
      {"completion", "zsh", "-o", mine},
      {"validate", burley, "--sarif", mine},
      {"test", "configs/graphs", "--junit", mine},
      {"calibrate", "-o", mine},
      {"sheet", "-o", mine},
      {"compare", "a.png", "b.png", "--heat", mine},
      {"compare", "a.png", "b.png", "--flip", "--flip-map", mine},
      joined(rendering(path("out")), {"--trace", mine}),
      {"bench", "record", "--csv", mine},
      {"bench", "record", "--html", mine},
      {"bench", "error-table", "--out", mine},
  };
  for (const Words& words : commands) {
    EXPECT_THAT(run(words), FailsWith(2, "mine.json' exists and is not a", "choose another path"))
        << ::testing::PrintToString(words);
    EXPECT_EQ(read("mine.json"), "{ \"mine\": 1 }") << ::testing::PrintToString(words);
  }
}

TEST_F(Outputs, FileOfAnotherKindInAFolder_IsRejectedAndKept) {
  const std::map<std::string, Words> commands = {
      {"frame_0001.png", rendering(path("o"))},
      {"color_0000.exr", rendering(path("o"))},
      {"frame_0000/combined.exr", {"apply", "-g", burley, "--frames", path("c"), "-o", path("o")}},
      {"frame_0000/reference.exr", {"reference", "--frames", path("c"), "-o", path("o")}},
      {"slots.md", {"docs", "-o", path("o")}},
      {"graph.schema.json", {"schema", "-o", path("o")}},
      {"index.html", {"bench", "all", "--quick", "--suites", "record", "-o", path("o")}},
      {"record.csv", {"bench", "all", "--quick", "--suites", "record", "-o", path("o")}},
  };
  for (const auto& [name, words] : commands) {
    write("o/" + name, "mine");
    EXPECT_THAT(run(words), FailsWith(2, name + "' exists and is not a")) << name;
    EXPECT_EQ(read("o/" + name), "mine");
    std::filesystem::remove_all(path("o"));
  }
}

TEST_F(Outputs, FilesOfAnEarlierRun_AreReplaced) {
  const std::string out = path("out"), picture = write("empty", "");
  const Words commands[] = {
      {"explain", burley, "-o", path("explained")},
      {"explain", burley, "--json", "-o", path("explained")},
      {"explain", "D0103", "-o", path("explained")},
      {"explain", "D0103", "--json", "-o", path("explained")},
      {"explain", "configs/graphs/skin.json", "--choices", "-o", path("explained")},
      {"explain", "configs/graphs/skin.json", "--choices", "--json", "-o", path("explained")},
      {"explain", burley, "--frame", "--size", "16x16", "-o", path("explained")},
      {"explain", burley, "--frame", "--size", "16x16", "--json", "-o", path("explained")},
      {"graph", burley, "-o", path("plan.dot")},
      {"graph", burley, "--json", "-o", path("plan.dot")},
      {"graph", burley, "--html", path("page.html")},
      {"plan", "save", burley, "-o", path("saved.plan")},
      {"schema", "graph", "-o", path("one.json")},
      {"schema", "-o", path("schemas")},
      {"docs", "-o", path("docs")},
      {"man", "-o", path("dermis.1")},
      {"completion", "bash", "-o", path("script")},
      {"completion", "zsh", "-o", path("script")},
      {"completion", "fish", "-o", path("script")},
      {"validate", burley, "--sarif", path("results.sarif")},
      {"test", "configs/graphs", "--junit", path("results.xml")},
      joined(rendering(out), {"--trace", path("trace.json")}),
      {"compare", out + "/frame_0000.png", out + "/frame_0001.png", "--heat", path("heat.png")},
      {"sheet", "-o", path("sheet.png"), "--graphs", burley, "--profiles",
       "configs/profiles/skin.json", "--size", "16x16"},
      {"bench", "record", "--quick", "--json", path("rows.json"), "--csv", path("rows.csv"),
       "--html", path("rows.html")},
  };
  for (const Words& words : commands) {
    EXPECT_THAT(run(words), Succeeds()) << ::testing::PrintToString(words);
    EXPECT_THAT(run(words), Succeeds()) << "again: " << ::testing::PrintToString(words);
  }
  EXPECT_THAT(run({"explain", burley, "-o", picture}), Succeeds()) << "an empty file";
}

TEST_F(Outputs, FolderInPlaceOfAFile_IsRejectedBeforeTheWork) {
  std::filesystem::create_directory(path("folder"));
  const Words commands[] = {
      {"explain", burley, "-o", path("folder")},
      {"graph", burley, "--html", path("folder")},
      {"plan", "save", burley, "-o", path("new/")},
      {"validate", burley, "--sarif", path("folder")},
      {"calibrate", "-o", path("folder")},
      {"sheet", "-o", path("folder")},
      {"compare", "a.png", "b.png", "--heat", path("folder")},
      joined(rendering(path("out")), {"--trace", path("folder")}),
      {"bench", "record", "--html", path("folder")},
      {"bench", "record", "--csv", path("folder")},
  };
  for (const Words& words : commands)
    EXPECT_THAT(run(words), FailsWith(2, "is a folder; expected the path of a file"))
        << ::testing::PrintToString(words);
  EXPECT_THAT(files(), ElementsAre("folder"));
}

TEST_F(Outputs, InputInTheOutputFolder_IsRejectedAndKept) {
  write("o/frame_0000.png", "mine");
  EXPECT_THAT(run(joined(rendering(path("o")),
                         {"--model", "head.glb", "--albedo", path("o/frame_0000.png")})),
              FailsWith(2, "--out: this command writes a file named like its input"));
  write("a/x.png", "mine");
  write("b/x.png", "mine");
  EXPECT_THAT(run({"compare", path("a"), path("b"), "--heat", path("b/x.png")}),
              FailsWith(2, "--heat: ", "is among the inputs of this command"));
  EXPECT_EQ(read("b/x.png"), "mine");
}

TEST_F(Outputs, OptionInPlaceOfAValue_IsRejected) {
  struct Case {
    Words words;
    const char* message;
  };
  const Case cases[] = {
      {{"render", scene, "-g", burley, "--out", "--size", "16x16"},
       "--out: the value is missing; '--size' is an option. Use '--out=--size' for this value"},
      {{"render", scene, "-g", burley, "-o", "--frames=2"}, "-o: the value is missing"},
      {{"render", scene, "-g", "-o", path("out")}, "-g: the value is missing; '-o' is an option"},
      {{"docs", "--out", "--quiet"}, "--out: the value is missing; '--quiet' is an option"},
  };
  for (const Case& one : cases)
    EXPECT_THAT(run(one.words), FailsWith(2, one.message)) << one.message;
  EXPECT_THAT(files(), IsEmpty());
  EXPECT_THAT(run({"explain", burley, "--out", path("--size")}), Succeeds());
}

TEST_F(Outputs, ImagesOfAnEarlierRun_AreNamed) {
  Words longer = rendering(path("out"));
  longer[7] = "4";
  ASSERT_THAT(run(longer), Succeeds());
  const Outcome shorter = run(rendering(path("out")));
  EXPECT_THAT(shorter, Succeeds());
  // burley.json exports scattered light: three images for each of the frames 2 and 3.
  EXPECT_THAT(shorter.err, HasAll("'color_0002.exr' and 5 more in '", "are of an earlier run"));
  EXPECT_THAT(run(longer).err, Not(HasSubstr("earlier run")));
  EXPECT_THAT(files("out"), Contains("color_0002.exr")) << "nothing is removed";

  const auto captured = [&](const char* frames) {
    return run({"capture", scene, "--size", "16x16", "--frames", frames, "-o", path("c")});
  };
  for (const Words& verb : {Words{"apply", "-g", burley}, Words{"reference"}}) {
    const Words words = joined(verb, {"--frames", path("c"), "-o", path("o_" + verb.front())});
    ASSERT_THAT(captured("2"), Succeeds());
    EXPECT_THAT(run(words).err, Not(HasSubstr("earlier run")));
    ASSERT_THAT(captured("1"), Succeeds());
    const Outcome again = run(words);
    EXPECT_THAT(again, Succeeds());
    EXPECT_THAT(again.err, HasAll("frame_0001/", "earlier run"));
  }
}

} // namespace
} // namespace dermis::test
