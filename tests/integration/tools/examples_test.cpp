// Runs the example of each verb's --help unchanged, on a small picture, with copies of the files it
// names.
#include "tests/integration/tools/command_fixture.hpp"

#include <cstdlib>
#include <filesystem>
#include <map>
#include <regex>
#include <sstream>

namespace dermis::test {
namespace {

namespace fs = std::filesystem;

// Suites that take minutes; their own tests run them small: bench_*_test.cpp, choice_test.cpp.
const std::vector<std::string> too_long = {
    "bench all",     "bench error-time", "bench budget",  "bench stability",
    "bench skip",    "bench truth",      "bench dynamic", "bench supplement",
    "bench compile", "bench record",     "bench restir",  "bench error-table"};

// Options that shorten an example, or let it end.
const std::map<std::string, std::string> shortened = {
    {"", "--subset 16"},
    {"render", "--subset 16"},
    {"watch", "--rounds 1 --frames 1 --subset 16"},
    {"capture", "--frames 2"},
    {"calibrate", "--frames 2 --overlay few.json"},
    {"report-bug", "--count 1"},
    {"reference", "--subset 16"},
    {"sheet", "--graphs sap --profiles skin"},
};

class Examples : public CommandTest {
protected:
  Examples() {
    for (const char* name : {"configs", "docs", "shaders", "tests/benchmark"}) {
      fs::create_directories(fs::path(path(name)).parent_path());
      fs::copy(fs::path(DERMIS_SOURCE_DIR) / name, path(name), fs::copy_options::recursive);
    }
  }

  // Runs a shell line in the test's folder, where `dermis` is the built command.
  int shell(const std::string& line) const {
    const std::string script = write("line.sh", "set -e -o pipefail\n" + line + "\n");
    const std::string words = "cd '" + path("") + "' && PATH='" +
                              fs::path(DERMIS_COMMAND).parent_path().string() + "':$PATH bash '" +
                              script + "' >'" + path("said") + "' 2>&1";
    return std::system(words.c_str());
  }

  // Returns the example lines of a help text.
  static std::vector<std::string> example_in(const std::string& help) {
    std::vector<std::string> found;
    const size_t from = help.find("Example:\n");
    if (from == std::string::npos) return found;
    std::istringstream lines(help.substr(from + 9));
    for (std::string line; std::getline(lines, line) && line.starts_with("  ");)
      found.push_back(line);
    return found;
  }

  static std::vector<std::string> words(const std::string& verb) {
    std::istringstream in(verb);
    return {std::istream_iterator<std::string>(in), {}};
  }

  // Returns a shortened line, without programs that may not be installed.
  static std::string small(const std::string& verb, std::string line, const std::string& help) {
    for (const char* other : {" | dot", " && man "})
      line = line.substr(0, line.find(other));
    line = std::regex_replace(line, std::regex("--size [0-9x]+"), "--size 64x36");
    line = std::regex_replace(line, std::regex("--frames [0-9]+"), "--frames 1");
    const bool takes_size = help.find("--size ") != std::string::npos || verb.empty();
    if (line.find("--size ") == std::string::npos && takes_size && !verb.starts_with("plan"))
      line += " --size 64x36";
    const auto more = shortened.find(verb);
    return more == shortened.end() ? line : line + " " + more->second;
  }
};

TEST_F(Examples, ExamplesOfEveryVerb_RunUnchanged) {
  // Files that the examples expect.
  write("few.json", techniques_alone);
  write("studio.json", R"({ "dermis_pass_types": 2, "pass_types": [
    { "name": "studio.tone", "ports": [ { "name": "toned", "usage": "storage_image_update" } ] } ] })");
  write("limits.json", R"({ "dermis_kernel_limits": 1, "rules": [
    { "graph": "*", "max": { "dispatches": 64 } } ] })");
  ASSERT_EQ(shell("dermis capture configs/scenes/bust.json --out capture --size 64x36 --frames 2\n"
                  "dermis plan save configs/graphs/burley.json --out before.plan\n"
                  "cp before.plan burley.plan\n"
                  "for name in a b; do dermis render configs/scenes/bust.json --graph "
                  "configs/graphs/sap.json "
                  "--size 64x36 --frames 8 --subset 0 --out out/$name; done"),
            0)
      << read("said");
  std::vector<std::string> verbs;
  for (const std::string& verb : verbs_of_help(run({"--help"}).out)) {
    verbs.push_back(verb);
    for (const std::string& inner : verbs_of_help(run({verb, "--help"}).out))
      verbs.push_back(verb + " " + inner);
  }
  EXPECT_GE(verbs.size(), 32u);
  verbs.emplace_back(""); // The command itself.
  size_t ran = 0;
  for (const std::string& verb : verbs) {
    if (std::find(too_long.begin(), too_long.end(), verb) != too_long.end()) continue;
    std::vector<std::string> requested = words(verb);
    requested.emplace_back("--help");
    const std::string help = run(requested).out;
    const std::vector<std::string> example = example_in(help);
    EXPECT_FALSE(example.empty()) << verb;
    for (const std::string& line : example) {
      const std::string typed = small(verb, line, help);
      EXPECT_EQ(shell(typed), 0) << typed << "\n" << read("said");
      ++ran;
    }
  }
  EXPECT_GE(ran, 25u);
}

} // namespace
} // namespace dermis::test
