// README.md and docs: what they show is run, compiled, and there.
#include "tests/integration/tools/command_fixture.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>

namespace dermis::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

const fs::path repository = DERMIS_SOURCE_DIR;

// Returns the code blocks of a language, in order.
std::vector<std::string> blocks(const std::string& text, const std::string& language) {
  std::vector<std::string> found;
  const std::string opening = "```" + language + "\n";
  for (size_t at = text.find(opening); at != std::string::npos; at = text.find(opening, at)) {
    at += opening.size();
    const size_t end = text.find("```", at);
    found.push_back(text.substr(at, end - at));
    at = end;
  }
  return found;
}

std::vector<std::string> words(const std::string& line) {
  std::istringstream in(line);
  std::vector<std::string> all;
  for (std::string word; in >> word;)
    all.push_back(word);
  return all;
}

class Readme : public CommandTest {
protected:
  const std::string text = read_text(repository / "README.md");

  // Runs a command line of the text on a small picture, with output in the test's folder.
  void expect_runs(const std::string& line) {
    std::vector<std::string> arguments = words(line.substr(0, line.find(" #")));
    ASSERT_GT(arguments.size(), 1u) << line;
    arguments.erase(arguments.begin()); // The program.
    for (size_t i = 0; i + 1 < arguments.size(); ++i) {
      if (arguments[i] == "--size") arguments[i + 1] = "64x36";
      if (arguments[i] == "--frames") arguments[i + 1] = "1";
      if (arguments[i] == "--out") arguments[i + 1] = path("out");
    }
    EXPECT_THAT(run(arguments), Succeeds()) << line << "\n";
  }
};

// Returns the complete graph of docs/format.md.
std::string complete_graph() {
  const std::string text = read_text(repository / "docs/format.md");
  const size_t section = text.find("## A complete graph");
  const auto shown = blocks(text.substr(std::min(section, text.size())), "jsonc");
  return shown.empty() ? "" : shown[0];
}

// Returns whether each member and element of `part` is in `whole`, at the same key.
bool contains(const json& whole, const json& part) {
  const auto is_in_whole = [&](const json& one) {
    return std::any_of(whole.begin(), whole.end(),
                       [&](const json& other) { return contains(other, one); });
  };
  if (part.is_array() && whole.is_array())
    return std::all_of(part.begin(), part.end(), is_in_whole);
  if (!part.is_object() || !whole.is_object()) return part == whole;
  return std::all_of(part.items().begin(), part.items().end(), [&](const auto& item) {
    return whole.contains(item.key()) && contains(whole[item.key()], item.value());
  });
}

TEST_F(Readme, CompleteGraphRuns) {
  const std::string shown = complete_graph();
  const std::string graph = write("shown.json", shown);
  EXPECT_THAT(run({"validate", graph}), Succeeds());
  EXPECT_THAT(run({"render", "configs/scenes/bust.json", "--graph", graph, "--size", "64x36",
                   "--frames", "1", "--out", path("out")}),
              Succeeds());
  EXPECT_THAT(shown, HasSubstr("\"albedo\": \"albedo\"")) << "the line would render white plaster";
}

TEST_F(Readme, ExcerptIsPartOfTheCompleteGraph) {
  const auto shown = blocks(text, "jsonc");
  ASSERT_EQ(shown.size(), 1u);
  const auto parsed = [](const std::string& jsonc) {
    return json::parse(jsonc, nullptr, false, true);
  };
  const json whole = parsed(complete_graph()), excerpt = parsed(shown[0]);
  ASSERT_TRUE(whole.is_object());
  ASSERT_TRUE(excerpt.is_object());
  EXPECT_TRUE(contains(whole, excerpt));
  json changed = excerpt;
  changed["passes"][0]["read"]["depth"] = "material";
  EXPECT_FALSE(contains(whole, changed));
}

TEST_F(Readme, EveryShellLineRuns) {
  size_t lines = 0;
  for (const std::string& block : blocks(text, "sh")) {
    std::istringstream in(block);
    for (std::string line; std::getline(in, line);) {
      if (line.starts_with("./")) {
        EXPECT_TRUE(fs::exists(repository / words(line)[0])) << line;
        continue;
      }
      ASSERT_TRUE(line.starts_with("build/release/dermis ")) << line;
      expect_runs(line);
      ++lines;
    }
  }
  EXPECT_GE(lines, 3u);
}

TEST_F(Readme, ToolsPageListsEveryVerb) {
  const std::string tools = read_text(repository / "docs/tools.md");
  const std::string help = run({"--help"}).out;
  const std::regex verb("\n  ([a-z][a-z-]+) ");
  size_t verbs = 0;
  for (std::sregex_iterator at(help.begin(), help.end(), verb), end; at != end; ++at) {
    const std::string name = (*at)[1];
    EXPECT_TRUE(std::regex_search(tools, std::regex("`" + name + "[ `]"))) << name;
    ++verbs;
  }
  EXPECT_GE(verbs, 18u) << help;
}

TEST_F(Readme, ShortCExamplesCompile) {
  auto shown = blocks(text, "c");
  ASSERT_EQ(shown.size(), 1u);
  const auto choice = blocks(read_text(repository / "docs/choice.md"), "c");
  ASSERT_EQ(choice.size(), 2u);
  std::string source = "#include <dermis/dermis.h>\n"
                       "dermis_context context; dermis_graph graph; dermis_report report;\n"
                       "dermis_slot slots[8]; uint32_t count; uint64_t completed_frame_index;\n"
                       "dermis_frame frame; uint32_t width, height; float frame_ms, others_ms;\n"
                       "void create(void); void choose(void); void scale(void);\n";
  source += "void create(void) {\n" + shown[0] + "}\nvoid choose(void) {\n" + choice[0] +
            "}\nvoid scale(void) {\n" + choice[1] + "}\n";
  const std::string file = write("shown.c", source);
  const std::string line = std::string(DERMIS_C_COMPILER) +
                           " -std=c99 -fsyntax-only -Wno-unused-result -I " +
                           (repository / "integration/include").string() + " " + file;
  EXPECT_EQ(std::system(line.c_str()), 0) << source;
}

// Links to files of the repository, in README.md and every page of docs.
TEST_F(Readme, EveryLinkLeadsToAFile) {
  std::vector<fs::path> pages = {repository / "README.md", repository / "CHANGELOG.md",
                                 repository / "CONTRIBUTING.md"};
  for (const auto& entry : fs::directory_iterator(repository / "docs"))
    if (entry.path().extension() == ".md") pages.push_back(entry.path());
  const std::regex link("\\]\\(([^)#:\\s]+)(#[^)]*)?\\)");
  size_t links = 0;
  for (const fs::path& page : pages) {
    const std::string contents = read_text(page);
    for (std::sregex_iterator at(contents.begin(), contents.end(), link), end; at != end; ++at) {
      EXPECT_TRUE(fs::exists(page.parent_path() / (*at)[1].str())) << page << ": " << (*at)[1];
      ++links;
    }
  }
  EXPECT_GT(links, 50u);
}

} // namespace
} // namespace dermis::test
