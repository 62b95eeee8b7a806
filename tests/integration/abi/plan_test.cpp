// docs/integration.md says which test holds what of the interface: tests that exist.

#include "tests/integration/abi/dermis_fixture.hpp"

#include <algorithm>
#include <filesystem>
#include <regex>
#include <set>

namespace dermis::abi_test {
namespace {

namespace fs = std::filesystem;

// "Suite.Name" of all tests below tests/, whether of a program or of the build.
std::set<std::string> all_tests() {
  const std::regex of_program(R"(\bTEST(?:_F|_P)?\(\s*(\w+),\s*(\w+)\))"),
      of_build(R"(NAME ([A-Z]\w*\.[\w${}]*))"), with_prefix(R"(TEST_PREFIX (\w+\.))");
  std::set<std::string> found;
  for (const auto& entry : fs::recursive_directory_iterator(fs::path(DERMIS_SOURCE_DIR) / "tests")) {
    const bool build = entry.path().filename() == "CMakeLists.txt";
    if (!build && entry.path().extension() != ".cpp") continue;
    const std::string text = read_text(fs::relative(entry.path(), DERMIS_SOURCE_DIR).string());
    const auto add = [&](const std::regex& what) {
      for (std::sregex_iterator at(text.begin(), text.end(), what), end; at != end; ++at)
        found.insert(at->size() > 2 ? (*at)[1].str() + "." + (*at)[2].str() : (*at)[1].str());
    };
    if (build) {
      add(of_build);
      add(with_prefix);
    } else {
      add(of_program);
    }
  }
  return found;
}

TEST(InterfacePlan, NamesTestsThatExist) {
  const std::set<std::string> tests = all_tests();
  const std::string text = read_text("docs/integration.md");
  const size_t begin = text.find("## How the interface is tested");
  ASSERT_NE(begin, std::string::npos);
  const std::string plan = text.substr(begin);
  const std::regex named("`([A-Z]\\w*\\.\\w*)(\xE2\x80\xA6)?`"); // `Suite.Name` or `Suite.Begi…`
  uint32_t count = 0;
  for (std::sregex_iterator at(plan.begin(), plan.end(), named), end; at != end; ++at, ++count) {
    const std::string name = (*at)[1].str();
    const bool begins = (*at)[2].matched;
    EXPECT_TRUE(std::ranges::any_of(tests, [&](const std::string& test) {
      return begins ? test.starts_with(name) : test == name;
    })) << name;
  }
  EXPECT_GE(count, 25u) << "the table names that many";
}

} // namespace
} // namespace dermis::abi_test
