#pragma once
// Whole files in and out. A file is either there complete or not there: never half-written.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace dermis::tools {

// Reads a regular file of at most `limit` bytes. Empty on failure, with one sentence in `error` that names
// the path.
std::optional<std::vector<uint8_t>> read_bytes(const std::filesystem::path& path, uint64_t limit,
                                               std::string& error);

// Writes through a temporary file beside the target and renames it over the target (atomic on POSIX file
// systems). On failure returns false, leaves the target as it was and no temporary file, and says why in
// `error`.
bool write_bytes(const std::filesystem::path& path, std::span<const uint8_t> bytes, std::string& error);
bool write_text(const std::filesystem::path& path, std::string_view text, std::string& error);

// A name beside `path` that no other call of any process uses at the same time.
std::filesystem::path temporary_beside(const std::filesystem::path& path);

} // namespace dermis::tools
