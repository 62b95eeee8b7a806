// Checks docs/papers.md: each statement of the papers has a row, and the files, functions and tests
// in the rows exist.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace dermis {
namespace {

namespace fs = std::filesystem;

const fs::path root = DERMIS_SOURCE_DIR;

std::string read(const fs::path& path) {
  std::ifstream file(path);
  std::ostringstream whole;
  whole << file.rdbuf();
  return whole.str();
}

struct Row {
  std::string ids, where, test;
};

std::string trimmed(const std::string& text) {
  const size_t first = text.find_first_not_of(' '), last = text.find_last_not_of(' ');
  return first == std::string::npos ? "" : text.substr(first, last - first + 1);
}

// Returns the rows of the tables whose first column is an id.
std::vector<Row> rows() {
  std::vector<Row> all;
  std::istringstream page(read(root / "docs/papers.md"));
  const std::regex an_id("[TDACFE][0-9].*");
  for (std::string line; std::getline(page, line);) {
    std::vector<std::string> cells;
    std::istringstream split(line);
    for (std::string cell; std::getline(split, cell, '|');)
      cells.push_back(trimmed(cell));
    if (cells.size() >= 5 && std::regex_match(cells[1], an_id)) all.push_back({cells[1], cells[3], cells[4]});
  }
  return all;
}

// Parses "A1 - A3" and "E4, E5".
std::vector<std::string> ids_of(const std::string& text) {
  std::vector<std::string> ids;
  const std::regex range("([A-Z])([0-9]+) - [A-Z]([0-9]+)"), one("[A-Z][0-9]+");
  std::smatch found;
  if (std::regex_match(text, found, range)) {
    for (int i = std::stoi(found[2]); i <= std::stoi(found[3]); ++i)
      ids.push_back(found[1].str() + std::to_string(i));
    return ids;
  }
  for (std::sregex_iterator it(text.begin(), text.end(), one), end; it != end; ++it)
    ids.push_back(it->str());
  return ids;
}

std::vector<std::string> quoted(const std::string& text) {
  std::vector<std::string> all;
  const std::regex code("`([^`]+)`");
  for (std::sregex_iterator it(text.begin(), text.end(), code), end; it != end; ++it)
    all.push_back((*it)[1]);
  return all;
}

// "..." and "*" match anything.
std::regex with_gaps(const std::string& text) {
  std::string pattern;
  const std::string dots = "\u2026";
  for (size_t i = 0; i < text.size(); ++i) {
    if (text.compare(i, dots.size(), dots) == 0) {
      pattern += "\\w*";
      i += dots.size() - 1;
    } else if (text[i] == '*') {
      pattern += "\\w*";
    } else {
      pattern += text[i];
    }
  }
  return std::regex(pattern);
}

TEST(PapersPage, HasARowForEachLineOfThePapers) {
  std::vector<std::string> there;
  for (const Row& row : rows())
    for (const std::string& id : ids_of(row.ids))
      there.push_back(id);
  size_t all = 0;
  for (const auto& [letter, last] :
       std::array<std::pair<char, int>, 6>{{{'T', 14}, {'D', 5}, {'A', 11}, {'C', 18}, {'F', 8}, {'E', 8}}})
    for (int i = 1; i <= last; ++i, ++all)
      EXPECT_EQ(std::count(there.begin(), there.end(), letter + std::to_string(i)), 1) << letter << i;
  EXPECT_EQ(there.size(), all);
}

TEST(PapersPage, NamedFilesAndFunctionsExist) {
  const std::regex path("([\\w./*]+/[\\w.*]*)(: (\\w+\\*?))?");
  size_t files = 0, functions = 0;
  for (const Row& row : rows())
    for (std::string name : quoted(row.where)) {
      std::smatch found;
      if (!std::regex_match(name, found, path)) continue;
      fs::path file = found[1].str();
      if (file.string().starts_with("S/")) file = "shaders" + file.string().substr(1);
      if (!file.has_parent_path() || !fs::exists(root / *file.begin())) file = "configs/scenes" / file;
      ++files;
      if (file.string().ends_with(".*")) {
        EXPECT_TRUE(fs::exists(root / fs::path(file).replace_extension(".hpp"))) << row.ids << ": " << name;
        continue;
      }
      ASSERT_TRUE(fs::exists(root / file)) << row.ids << ": " << name;
      if (!found[3].matched) continue;
      ++functions;
      EXPECT_TRUE(std::regex_search(read(root / file), with_gaps("\\b" + found[3].str() + "\\b")))
          << row.ids << ": " << name;
    }
  EXPECT_GT(files, 30u);
  EXPECT_GE(functions, 8u);
}

TEST(PapersPage, NamedFunctionsAndSettingsExist) {
  std::string code;
  for (const char* folder :
       {"passes", "shaders", "configs/graphs", "integration/tools/references", "tests/passes"})
    for (const auto& entry : fs::recursive_directory_iterator(root / folder))
      if (entry.is_regular_file()) code += read(entry.path());
  size_t names = 0;
  const std::regex plain("\\w+\\*?");
  for (const Row& row : rows())
    for (const std::string& name : quoted(row.where)) {
      if (!std::regex_match(name, plain)) continue;
      ++names;
      EXPECT_TRUE(std::regex_search(code, with_gaps("\\b" + name + "\\b"))) << row.ids << ": " << name;
    }
  EXPECT_GT(names, 15u);
}

TEST(PapersPage, NamedTestsExist) {
  std::vector<std::string> tests; // "Suite.Name"
  const std::regex declared("\\bTEST(?:_F|_P)?\\(\\s*(\\w+),\\s*(\\w+)\\)");
  for (const auto& entry : fs::recursive_directory_iterator(root / "tests"))
    if (entry.path().extension() == ".cpp") {
      const std::string text = read(entry.path());
      for (std::sregex_iterator it(text.begin(), text.end(), declared), end; it != end; ++it)
        tests.push_back((*it)[1].str() + "." + (*it)[2].str());
    }
  ASSERT_GT(tests.size(), 500u);
  size_t named = 0;
  for (const Row& row : rows()) {
    std::string suite;
    for (const std::string& name : quoted(row.test)) {
      if (name.starts_with("dermis ")) continue; // A command.
      const size_t dot = name.find('.');
      // The next name may omit the suite.
      if (dot != std::string::npos) suite = name.substr(0, dot);
      const std::regex wanted =
          with_gaps(suite + "\\." + (dot == std::string::npos ? name : name.substr(dot + 1)));
      EXPECT_TRUE(std::any_of(tests.begin(), tests.end(),
                              [&](const std::string& one) { return std::regex_match(one, wanted); }))
          << row.ids << ": " << name;
      ++named;
    }
  }
  EXPECT_GT(named, 40u);
}

} // namespace
} // namespace dermis
