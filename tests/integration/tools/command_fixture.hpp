#pragma once
// Runs the built command in a folder of its own, as a shell would, and keeps what it said.

#include "tests/support/test_folder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

namespace dermis::test {

struct Outcome {
  int exit_code = -1; // 128 + signal if one ended it
  std::string out, err;
};

struct RunOptions {
  std::vector<std::string> environment; // "NAME=value", added
  std::string input;                    // standard input
  std::string interrupt_after;          // sends SIGINT as soon as this path exists; "": never
};

class CommandTest : public ::testing::Test {
protected:
  // Runs `dermis` with these arguments, from the repository's root.
  static Outcome run(const std::vector<std::string>& arguments, const RunOptions& options = {});

  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::string write(const std::string& name, const std::string& text) const; // returns its path
  std::string read(const std::string& name) const; // all of it; "" where there is no such file
  // Files and folders inside, relative, sorted; also what is hidden or temporary.
  std::vector<std::string> files(const std::string& below = "") const;

private:
  const TestFolder folder_;
};

inline constexpr const char* burley = "configs/graphs/burley.json";

// An overlay on configs/graphs/skin.json whose budget chooses among its four techniques and no steps of
// theirs, which makes calibrating it short.
inline constexpr const char* techniques_alone = R"({ "dermis_overlay": 2, "edits": [
  { "set": "/settings/variant", "to": { "choice": ["base", "smooth", "half"], "default": "smooth" } },
  { "set": "/settings/taps", "to": { "choice": ["11", "17", "25"], "default": "25" } } ] })";

std::string text_of(const std::filesystem::path& file); // all of it; "" where there is no such file

// Variables under which the Khronos layer checks everything that the command asks of the driver,
// synchronization included; what it finds goes to standard output.
std::vector<std::string> validation_environment();

// The verbs that a help text lists: what stands between "Subcommands:" and the next empty line.
std::vector<std::string> verbs_of_help(const std::string& help);

// True if `text` is one JSON document and nothing else.
bool is_json(const std::string& text);

} // namespace dermis::test
