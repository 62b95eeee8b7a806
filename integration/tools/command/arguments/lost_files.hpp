#pragma once
// Finds files that a command would destroy. Internal to arguments/.

#include <CLI/CLI.hpp>

#include <string>

namespace dermis::tools {

// Returns the usage error if an output of the parsed command line would replace a file that the
// command reads, or another of its outputs; else "".
std::string find_lost_file(const CLI::App& app);

} // namespace dermis::tools
