#include "framegraph/text/file_roots.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <system_error>

namespace dermis {

namespace fs = std::filesystem;

namespace {

constexpr std::array<std::string_view, 4> project_folders = {"graphs", "overlays", "profiles",
                                                             "scenes"};

fs::path or_working_folder(const fs::path& folder) {
  return folder.empty() ? fs::path(".") : folder;
}

// Resolves links and steps such as "..". Parts that do not exist stay as given.
fs::path real_path(const fs::path& path, std::error_code& error) {
  fs::path real = fs::absolute(or_working_folder(path), error);
  if (!error) real = fs::weakly_canonical(real, error);
  return real.has_filename() ? real : real.parent_path(); // "folder/" is "folder"
}

bool is_below(const fs::path& path, const fs::path& root) {
  return std::mismatch(root.begin(), root.end(), path.begin(), path.end()).first == root.end();
}

} // namespace

PlacedFile place_file(const fs::path& folder, std::string_view name,
                      std::span<const fs::path> roots) {
  PlacedFile placed;
  if (name.empty() || name.find('\0') != std::string_view::npos) {
    placed.problem = "it is not a file name";
    return placed;
  }
  // exactly the path that will be opened
  placed.path = (folder / fs::path(name)).lexically_normal();
  std::error_code error;
  placed.real = real_path(placed.path, error);
  if (error) {
    placed.problem = error.message();
    return placed;
  }
  std::string readable;
  for (const fs::path& root : roots) {
    const fs::path real_root = real_path(root, error);
    if (!error && is_below(placed.real, real_root)) return placed;
    readable +=
        fmt::format("{}'{}'", readable.empty() ? "" : ", ", or_working_folder(root).string());
  }
  placed.problem = fmt::format("it is outside the readable folders {}", readable);
  return placed;
}

fs::path home_of(const fs::path& file) {
  std::error_code error;
  const fs::path folder = fs::absolute(file, error).lexically_normal().parent_path();
  const std::string name = folder.filename().string();
  const bool project =
      std::find(project_folders.begin(), project_folders.end(), name) != project_folders.end();
  // Returns the folder as the file was named, so that messages show what the user wrote.
  const fs::path own = file.parent_path();
  if (!project) return own;
  return (or_working_folder(own) / "..").lexically_normal();
}

} // namespace dermis
