#pragma once
// Finds files that ship with the command, in the source tree or in the installation.

#include <string>
#include <string_view>
#include <vector>

namespace dermis::tools {

// `path` begins with "configs/", or with "tests/" for benchmark inputs. Returns the first that
// exists: `path` relative to the working directory, or the file below share/dermis next to the
// running program's folder. Returns `path` if neither exists.
std::string shipped(const std::string& path);

// Returns the file of a plain name in a folder of configs, for example "sap" in "graphs". Falls
// back to the subfolder `papers`.
std::string shipped(std::string_view folder, std::string_view name);

// Replaces plain names by files of a folder of configs; keeps paths, which contain '.' or '/'.
std::vector<std::string> shipped_files(std::string_view folder,
                                       std::vector<std::string> names_or_paths);

// Returns "did you mean 'configs/graphs/sap.json'?" if a shipped graph has a name like that of
// `path`, else "".
std::string did_you_mean_graph(const std::string& path);

// Returns the graph files in a folder and below, sorted by file name; not the expectations.
std::vector<std::string> graph_files(const std::string& folder);

} // namespace dermis::tools
