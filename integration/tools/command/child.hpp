#pragma once
// Runs another program to its end.

#include <optional>
#include <string>
#include <vector>

namespace dermis::tools {

struct ChildAnswer {
  int exit_code = -1; // 128 + signal number if a signal ended the program
  std::string out;    // standard output of the program
};

// Runs `words[0]` with the remaining words as arguments; standard error is inherited. An interrupt
// of this program also interrupts the child. Returns nullopt and sets `problem` if the program
// could not be started, or its exit code is unknown.
std::optional<ChildAnswer> run_child(const std::vector<std::string>& words, std::string& problem);

} // namespace dermis::tools
