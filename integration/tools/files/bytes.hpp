#pragma once
// Reads and writes whole files. Writing is atomic: a file is never left half-written.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace dermis::tools {

// Reads a regular file of at most `limit` bytes. On failure returns nullopt and sets `error` to one
// sentence that names the path.
std::optional<std::vector<uint8_t>> read_bytes(const std::filesystem::path& path, uint64_t limit,
                                               std::string& error);

// Writes a temporary file next to the target and renames it over the target (atomic on POSIX file
// systems). On failure returns false, sets `error`, and leaves the target unchanged and no
// temporary file. Devices and pipes are written to.
bool write_bytes(const std::filesystem::path& path, std::span<const uint8_t> bytes,
                 std::string& error);
bool write_text(const std::filesystem::path& path, std::string_view text, std::string& error);

// Returns a name next to `path` that no other call of any process uses at the same time.
std::filesystem::path temporary_path(const std::filesystem::path& path);

} // namespace dermis::tools
