#pragma once
// Finds files that ship with the command, in the source tree or in the installation.

#include <string>
#include <string_view>

namespace dermis::tools {

// `path` begins with "configs/", or with "tests/" for benchmark inputs. Returns the first that
// exists: `path` relative to the working directory, or the file below share/dermis next to the
// running program's folder. Returns `path` if neither exists.
std::string shipped(const std::string& path);

// Returns the file of a plain name in a folder of configs, for example "sap" in "graphs". Falls
// back to the subfolder `papers`.
std::string shipped(std::string_view folder, std::string_view name);

} // namespace dermis::tools
