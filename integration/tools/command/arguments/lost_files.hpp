#pragma once
// Finds files that a command would destroy. Internal to arguments/. In both functions `verb` is the
// words that name the verb, such as "bench all".

#include <CLI/CLI.hpp>

#include <string>
#include <string_view>

namespace dermis::tools {

// Returns the usage error if an output of the parsed command line would replace a file that the
// command reads, or another of its outputs; else "".
std::string find_lost_file(const CLI::App& app, std::string_view verb);
// Returns the usage error if an output is a folder in place of a file, or would replace a file of
// another kind than the verb writes; else "".
std::string find_foreign_file(const CLI::App& app, std::string_view verb);

} // namespace dermis::tools
