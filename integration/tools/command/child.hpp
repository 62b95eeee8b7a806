#pragma once
// Another program, run to its end.

#include <optional>
#include <string>
#include <vector>

namespace dermis::tools {

struct ChildAnswer {
  int exit_code = -1; // 128 + signal if one ended it
  std::string out;    // what it wrote to standard output
};

// Runs `words[0]` with the rest as its arguments; standard error is ours. Where this program is asked to
// stop, it is asked, too. nullopt with the reason in `problem`: it could not be started.
std::optional<ChildAnswer> run_child(const std::vector<std::string>& words, std::string& problem);

} // namespace dermis::tools
