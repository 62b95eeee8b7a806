#pragma once
// Where the files are that ship with the command: beside the sources, or where it was installed.

#include <string>
#include <string_view>

namespace dermis::tools {

// `path` begins with "configs/", or with "tests/" for what benches measure. The path itself where it exists
// from here, so that sources come first; else the file below share/dermis beside the folder of the running
// program, where that exists; else the path itself.
std::string shipped(const std::string& path);

// The file of a plain name in a folder of configs: "sap" of "graphs", for example. Where it is not there,
// it is looked for in the folder papers below.
std::string shipped(std::string_view folder, std::string_view name);

} // namespace dermis::tools
