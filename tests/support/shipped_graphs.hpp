#pragma once
// The shipped graphs: configs/graphs has the graphs of the product, its folder `papers` baselines
// and reproductions.

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

namespace dermis::shipped {

// Returns paths from the root of the sources, sorted by the graph's name.
inline std::vector<std::string> graph_files() {
  namespace fs = std::filesystem;
  const fs::path root = DERMIS_SOURCE_DIR;
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(root / "configs/graphs"))
    if (const std::string name = entry.path().filename().string();
        name.ends_with(".json") && !name.ends_with(".expect.json"))
      files.push_back(fs::relative(entry.path(), root));
  std::sort(files.begin(), files.end(),
            [](const fs::path& a, const fs::path& b) { return a.filename() < b.filename(); });
  std::vector<std::string> paths;
  for (const fs::path& file : files)
    paths.push_back(file.generic_string());
  return paths;
}

// Returns the path of a graph such as "sap" from the root of the sources. For an unknown graph it
// is a path in the product's folder.
inline std::string graph_file(const std::string& name) {
  for (const std::string& path : graph_files())
    if (std::filesystem::path(path).stem() == name) return path;
  return "configs/graphs/" + name + ".json";
}

} // namespace dermis::shipped
