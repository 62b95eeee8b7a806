// Tests dermis completion and dermis man: they match the command line, and shells accept them.
#include "tests/integration/tools/command_fixture.hpp"

#include <cstdlib>

namespace dermis::test {
namespace {

class Shell : public CommandTest {
protected:
  // Returns the output of a shell line; `code` is its exit status.
  std::string shell(const std::string& line, int& code) const {
    code = std::system((line + " > '" + path("said") + "' 2>&1").c_str());
    return read("said");
  }
  static bool has(const char* program) {
    return std::system((std::string("command -v ") + program + " > /dev/null 2>&1").c_str()) == 0;
  }
  // Returns bash's completions of these words.
  std::string offered(const std::string& words, int last) const {
    int code = 0;
    return shell(
        "bash -c 'source \"$0\"; COMP_WORDS=(" + words + "); COMP_CWORD=" + std::to_string(last) +
            "; _dermis; printf \"%s\\n\" \"${COMPREPLY[@]}\"' '" + path("dermis.bash") + "'",
        code);
  }
};

TEST_F(Shell, BashCompletesVerbsOptionsAndValues) {
  ASSERT_EQ(run({"completion", "bash", "--out", path("dermis.bash")}).exit_code, 0);
  EXPECT_EQ(offered("dermis val", 1), "validate\n");
  EXPECT_EQ(offered("dermis bench error-ti", 2), "error-time\n");
  EXPECT_EQ(offered("dermis graph --htm", 2), "--html\n");
  EXPECT_EQ(offered("dermis bench all --agai", 3), "--again\n");
  EXPECT_EQ(offered("dermis graph --color n", 3), "never\n");
  EXPECT_EQ(offered("dermis completion z", 2), "zsh\n");
  EXPECT_EQ(offered("dermis schema prof", 2), "profile\n");
  EXPECT_EQ(offered("dermis explain D029", 2), "\n");
  EXPECT_EQ(offered("dermis explain D022", 2),
            "D0220\nD0221\nD0222\nD0223\nD0224\nD0225\nD0226\nD0227\nD0228\nD0229\n");
  EXPECT_EQ(offered("dermis explain configs/graphs/sap.j", 2), "configs/graphs/sap.json\n");
  EXPECT_EQ(offered("dermis bench all --suites rec", 4), "record\n");
  EXPECT_THAT(offered("dermis graph configs/gra", 2), HasSubstr("configs/graphs"));
  EXPECT_THAT(offered("dermis render configs/scenes/bust.json --graph configs/graphs/sap.", 4),
              HasSubstr("configs/graphs/sap.json"));
}

TEST_F(Shell, OtherShellsAcceptTheirScripts) {
  bool tried = false;
  for (const char* name : {"zsh", "fish"}) {
    ASSERT_EQ(run({"completion", name, "--out", path(name)}).exit_code, 0);
    if (!has(name)) continue;
    tried = true;
    int code = 0;
    const std::string said = shell(std::string(name) + " -n '" + path(name) + "'", code);
    EXPECT_EQ(code, 0) << said;
  }
  if (!tried) GTEST_SKIP() << "neither zsh nor fish is installed";
}

TEST_F(Shell, OtherShellsCompleteSchemasAndCodes) {
  const std::string zsh = run({"completion", "zsh"}).out;
  EXPECT_THAT(zsh, HasAll("'*:argument:(graph fragment ",
                          "'*:argument:_alternative \"files:file:_files\" \"words:word:(D0101 "));
  ASSERT_EQ(run({"completion", "fish", "--out", path("fish")}).exit_code, 0);
  if (!has("fish")) GTEST_SKIP() << "fish is not installed";
  int code = 0;
  const auto offered_by_fish = [&](const std::string& line) {
    return shell("fish -c 'source \"" + path("fish") + "\"; complete -C \"" + line + "\"'", code);
  };
  EXPECT_EQ(offered_by_fish("dermis schema prof"), "profile\n");
  EXPECT_EQ(offered_by_fish("dermis explain D0103"), "D0103\n");
}

TEST_F(Shell, ScriptsAndManualNameEveryVerbOfTheHelp) {
  const std::string manual = run({"man"}).out;
  const std::string fish = run({"completion", "fish"}).out, zsh = run({"completion", "zsh"}).out;
  const std::vector<std::string> verbs = verbs_of_help(run({"--help"}).out);
  for (const std::string& verb : verbs) {
    EXPECT_THAT(fish, HasSubstr(" -a " + verb + " ")) << verb;
    EXPECT_THAT(zsh, HasSubstr("        '" + verb + ":")) << verb;
    std::string escaped; // roff escapes hyphens.
    for (const char c : verb)
      escaped += c == '-' ? std::string("\\-") : std::string(1, c);
    EXPECT_NE(manual.find(".SS \"" + escaped), std::string::npos) << verb;
  }
  EXPECT_GE(verbs.size(), 15u);
  EXPECT_THAT(manual,
              HasAll("\\fB\\-\\-html\\fR \\fIFILE\\fR", "dermis bench all \\-\\-out build/bench"));
}

TEST_F(Shell, ManualIsFormattedWithoutWarnings) {
  ASSERT_EQ(run({"man", "--out", path("dermis.1")}).exit_code, 0);
  if (!has("groff")) GTEST_SKIP() << "groff is not installed";
  int code = 0;
  EXPECT_EQ(shell("groff -man -Tutf8 -ww -z '" + path("dermis.1") + "'", code), "");
  EXPECT_EQ(code, 0);
}

TEST_F(Shell, UnknownShell_IsAUsageError) {
  EXPECT_EQ(run({"completion", "csh"}).exit_code, 2);
}

} // namespace
} // namespace dermis::test
