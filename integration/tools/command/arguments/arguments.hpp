#pragma once
// Command line -> the verb to run. Knows the syntax of every verb, none of their work.

#include "integration/tools/command/session.hpp"

#include <functional>
#include <map>
#include <string>
#include <vector>

namespace CLI {
class Option;
}

namespace dermis::tools {

// Words that completion offers for the value of an option, beside others that it takes.
using OfferedWords = std::map<const CLI::Option*, std::vector<std::string>>;

struct Invocation {
  Session session;
  std::function<ExitCode(const Session&)>
      run;             // empty: nothing to do (help, or a usage error that is in `message`)
  std::string help;    // asked for: goes to stdout
  std::string message; // usage error
  OfferedWords offered;
};

Invocation read_arguments(int argc, const char* const* argv);

// "640x360" -> 640, 360. Returns what is wrong, "" for nothing. Each side 1..16384.
std::string parse_size(const std::string& text, uint32_t& width, uint32_t& height);

} // namespace dermis::tools
