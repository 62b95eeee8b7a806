#pragma once
// Parses the command line into the verb to run. Knows the syntax of every verb, but not its
// implementation.

#include "integration/tools/command/session.hpp"

#include <functional>
#include <map>
#include <string>
#include <vector>

namespace CLI {
class Option;
}

namespace dermis::tools {

// Words that completion suggests for the value of an option, in addition to its fixed values.
using OfferedWords = std::map<const CLI::Option*, std::vector<std::string>>;

struct Invocation {
  Session session;
  // Empty after a help request or a usage error.
  std::function<ExitCode(const Session&)> run;
  std::string help;    // requested help text, for stdout
  std::string message; // usage error
  OfferedWords offered;
};

Invocation read_arguments(int argc, const char* const* argv);

// Parses "640x360" into 640 and 360; each side 1..16384. Returns the problem, or "".
std::string parse_size(const std::string& text, uint32_t& width, uint32_t& height);

} // namespace dermis::tools
