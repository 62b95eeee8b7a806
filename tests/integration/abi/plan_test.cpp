// Checks that the tests named in docs/integration.md (interface) and docs/security.md (hostile
// files) exist.

#include "tests/integration/abi/dermis_fixture.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <set>

namespace dermis::abi_test {
namespace {

namespace fs = std::filesystem;

// Returns the word at `at`, and moves `at` past it.
std::string word(const std::string& text, size_t& at) {
  const size_t begin = at;
  while (at < text.size() &&
         (std::isalnum(static_cast<unsigned char>(text[at])) != 0 || text[at] == '_'))
    ++at;
  return text.substr(begin, at - begin);
}

// Adds "First.Second" for each `mark` that is followed by two words separated by `between`.
void add_names(const std::string& text, const std::string& mark, const std::string& between,
               std::set<std::string>& found) {
  for (size_t at = text.find(mark); at != std::string::npos; at = text.find(mark, at)) {
    at += mark.size();
    const std::string suite = word(text, at);
    if (text.compare(at, between.size(), between) != 0) continue;
    at += between.size();
    while (at < text.size() && std::isspace(static_cast<unsigned char>(text[at])) != 0)
      ++at; // The formatter may break lines here.
    found.insert(suite + "." + word(text, at));
  }
}

// Returns the names of all tests below tests/, of programs and of the build.
std::set<std::string> all_tests() {
  std::set<std::string> found;
  for (const auto& entry :
       fs::recursive_directory_iterator(fs::path(DERMIS_SOURCE_DIR) / "tests")) {
    const bool build = entry.path().filename() == "CMakeLists.txt";
    if (!build && entry.path().extension() != ".cpp") continue;
    const std::string text = read_text(fs::relative(entry.path(), DERMIS_SOURCE_DIR).string());
    if (build) {
      add_names(text, "NAME ", ".", found);
      add_names(text, "TEST_PREFIX ", ".", found);
    } else {
      for (const char* mark : {"\nTEST(", "\nTEST_F(", "\nTEST_P("})
        add_names(text, mark, ",", found);
    }
  }
  return found;
}

// Expects that each test named after `heading` exists, and that at least `minimum` are named.
void expect_tests_exist(const std::string& page, const std::string& heading, uint32_t minimum) {
  const std::set<std::string> tests = all_tests();
  const std::string text = read_text(page);
  size_t at = text.find(heading);
  ASSERT_NE(at, std::string::npos);
  const std::string cut = "\xE2\x80\xA6`"; // `Suite.Begi…`
  uint32_t count = 0;
  for (at = text.find('`', at); at != std::string::npos; at = text.find('`', at)) {
    const std::string suite = word(text, ++at);
    if (suite.empty() || std::isupper(static_cast<unsigned char>(suite[0])) == 0 || text[at] != '.')
      continue;
    const std::string name = suite + "." + word(text, ++at);
    const bool begins = text.compare(at, cut.size(), cut) == 0;
    if (!begins && text[at] != '`') continue;
    ++count;
    EXPECT_TRUE(std::ranges::any_of(tests, [&](const std::string& test) {
      return begins ? test.starts_with(name) : test == name;
    })) << name;
  }
  EXPECT_GE(count, minimum) << "the page names at least that many";
}

TEST(InterfacePlan, NamesTestsThatExist) {
  expect_tests_exist("docs/integration.md", "## How the interface is tested", 35);
}

TEST(ThreatModel, NamesTestsThatExist) {
  expect_tests_exist("docs/security.md", "# Security", 30);
}

} // namespace
} // namespace dermis::abi_test
