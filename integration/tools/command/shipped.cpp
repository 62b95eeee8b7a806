#include "integration/tools/command/shipped.hpp"

#include "framegraph/text/suggest.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <string_view>

namespace dermis::tools {

std::string shipped(const std::string& path) {
  namespace fs = std::filesystem;
  const auto prefix = std::string_view(path).substr(0, path.find('/') + 1);
  std::error_code error;
  if (fs::exists(path, error) || (prefix != "configs/" && prefix != "tests/")) return path;
  // only on Linux; other systems find only the sources
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  if (error) return path;
  const fs::path installed =
      program.parent_path().parent_path() / "share" / "dermis" / path.substr(prefix.size());
  return fs::exists(installed, error) ? installed.string() : path;
}

std::string shipped(std::string_view folder, std::string_view name) {
  const auto below = [&](std::string_view more) {
    return shipped(
        std::string("configs/").append(folder).append(more).append(name).append(".json"));
  };
  std::error_code error;
  std::string found = below("/");
  if (std::string of_papers = below("/papers/");
      !std::filesystem::exists(found, error) && std::filesystem::exists(of_papers, error))
    return of_papers;
  return found;
}

std::vector<std::string> shipped_files(std::string_view folder,
                                       std::vector<std::string> names_or_paths) {
  for (std::string& file : names_or_paths)
    if (file.find_first_of("./") == std::string::npos) file = shipped(folder, file);
  return names_or_paths;
}

std::vector<std::string> graph_files(const std::string& folder) {
  std::vector<std::filesystem::path> files;
  std::error_code error;
  for (std::filesystem::recursive_directory_iterator at(folder, error), end; !error && at != end;
       at.increment(error))
    if (at->path().extension() == ".json" && !at->path().string().ends_with(".expect.json"))
      files.push_back(at->path());
  std::sort(files.begin(), files.end(),
            [](const auto& a, const auto& b) { return a.filename() < b.filename(); });
  return {files.begin(), files.end()};
}

std::string did_you_mean_graph(const std::string& path) {
  const std::vector<std::string> files = graph_files(shipped("configs/graphs"));
  std::vector<std::string> names;
  for (const std::string& file : files)
    names.push_back(std::filesystem::path(file).stem().string());
  const std::vector<std::string_view> words(names.begin(), names.end());
  const std::string_view name = nearest(std::filesystem::path(path).stem().string(), words);
  for (size_t i = 0; i < files.size() && !name.empty(); ++i)
    if (names[i] == name) return fmt::format("did you mean '{}'?", files[i]);
  return "";
}

} // namespace dermis::tools
