#pragma once
// Restricts the files that other files may name to declared folders (docs/security.md).

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace dermis {

struct PlacedFile {
  std::filesystem::path path; // folder and name without ".." steps; the path to open
  std::filesystem::path real; // path with links resolved; may not exist
  std::string problem;        // "": the path is below one of the roots
};

// Resolves `name`, as written in a file in `folder` ("": the working folder). The result must be
// below one of `roots` after all links are followed. Inspects folders and links, but opens nothing.
// Any thread.
PlacedFile place_file(const std::filesystem::path& folder, std::string_view name,
                      std::span<const std::filesystem::path> roots);

// Returns the folder that a file may always name: its own folder or, if that is a project's
// "graphs", "overlays", "profiles" or "scenes" folder, the project's folder. Any thread.
std::filesystem::path home_of(const std::filesystem::path& file);

} // namespace dermis
