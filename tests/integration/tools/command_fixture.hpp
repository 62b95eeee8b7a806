#pragma once
// Runs the built command in a temporary folder, as a shell would, and stores its output.

#include "tests/support/matchers.hpp"
#include "tests/support/test_folder.hpp"
#include "tests/support/text_file.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace dermis::test {

struct Outcome {
  int exit_code = -1; // 128 + signal if a signal ended the command.
  std::string out, err;
};

void PrintTo(const Outcome& outcome, std::ostream* stream); // for messages of GoogleTest

struct RunOptions {
  std::vector<std::string> environment = {}; // Additional variables, "NAME=value".
  std::string input = {};                    // Standard input.
  std::string interrupt_after = {};          // Sends SIGINT as soon as this path exists; "": never.
  std::string output = {};                   // File for standard output; "": Outcome::out.
};

class CommandTest : public ::testing::Test {
protected:
  // Runs `dermis` with these arguments, from the repository's root.
  static Outcome run(const std::vector<std::string>& arguments, const RunOptions& options = {});

  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  // Returns the file's path.
  std::string write(const std::string& name, const std::string& text) const;
  // Returns the whole file, or "" if it does not exist.
  std::string read(const std::string& name) const;
  // Returns the files and folders inside, relative and sorted, including hidden and temporary
  // files.
  std::vector<std::string> files(const std::string& below = "") const;
  // Expects the same bytes in each EXR file of folder `a` and the file of its name in `b`.
  void expect_equal_pictures(const std::string& a, const std::string& b) const;
  // Copies the folder of shaders and returns the copy's path.
  std::string copy_shaders() const;
  static bool has_shader_compiler();

private:
  const TestFolder folder_;
};

inline constexpr const char* burley = "configs/graphs/burley.json";

// An overlay on configs/graphs/skin.json whose budget only chooses among its techniques,
// without their steps, which keeps calibration short.
inline constexpr const char* techniques_alone = R"({ "dermis_overlay": 2, "edits": [
  { "set": "/settings/variant", "to": { "choice": ["base", "smooth", "half"], "default": "smooth" } },
  { "set": "/settings/taps", "to": { "choice": ["11", "17", "25"], "default": "25" } } ] })";

// Returns variables that make the Khronos layer check all driver calls of the command, including
// synchronization. Messages go to standard output.
std::vector<std::string> validation_environment();

// Returns the verbs of a help text: the lines between "Subcommands:" and the next empty line.
std::vector<std::string> verbs_of_help(const std::string& help);

// Returns whether `text` is exactly one JSON document.
bool is_json(const std::string& text);

MATCHER(IsJson, "is one JSON document") {
  return is_json(arg);
}

// Matches an outcome without an error whose output has all texts and satisfies all matchers.
template <class... Texts> auto Succeeds(const Texts&... texts) {
  return AllOf(::testing::Field("exit_code", &Outcome::exit_code, 0),
               ::testing::Field("out", &Outcome::out, HasAll("", texts...)));
}

// Matches an outcome with this exit code whose messages have all texts and satisfy all matchers.
template <class... Texts> auto FailsWith(int exit_code, const Texts&... texts) {
  return AllOf(::testing::Field("exit_code", &Outcome::exit_code, exit_code),
               ::testing::Field("err", &Outcome::err, HasAll("", texts...)));
}

} // namespace dermis::test
