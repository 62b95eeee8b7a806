#pragma once
// Where files that other files name may lie: below declared folders and nowhere else (docs/security.md).

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace dermis {

struct PlacedFile {
  std::filesystem::path path; // of folder and name, without steps that lead back; to be opened
  std::filesystem::path real; // what links make of it; nothing may be there
  std::string problem;        // "": the place is below one of the roots
};

// The place that `name` means to a file in `folder` ("": the working folder), if it is below one of `roots`
// once all links are followed. Looks at folders and links, opens nothing. Any thread.
PlacedFile place_file(const std::filesystem::path& folder, std::string_view name,
                      std::span<const std::filesystem::path> roots);

// What a file may name without being asked: the folder that it is in or, where that is the folder "graphs",
// "overlays", "profiles" or "scenes" of a project, the project's. Any thread.
std::filesystem::path home_of(const std::filesystem::path& file);

} // namespace dermis
