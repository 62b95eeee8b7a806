#pragma once
// Where the files are that ship with the command: beside the sources, or where it was installed.

#include <string>

namespace dermis::tools {

// `path` begins with "configs/", or with "tests/" for what benches measure. The path itself where it exists
// from here, so that sources come first; else the file below share/dermis beside the folder of the running
// program, where that exists; else the path itself.
std::string shipped(const std::string& path);

} // namespace dermis::tools
