#include "integration/tools/files/bytes.hpp"

#include <fmt/format.h>

#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <system_error>

namespace dermis::tools {

namespace fs = std::filesystem;

namespace {

struct Close {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, Close>;

// Returns whether everything was written; else errno states the reason.
bool write_file(const fs::path& path, std::span<const uint8_t> bytes) {
  File file(std::fopen(path.c_str(), "wb"));
  if (!file || std::fwrite(bytes.data(), 1, bytes.size(), file.get()) != bytes.size()) return false;
  // A full disk may only be reported when the buffer is flushed.
  return std::fclose(file.release()) == 0;
}

std::string last_error() {
  return std::generic_category().message(errno);
}

} // namespace

std::optional<std::vector<uint8_t>> read_bytes(const fs::path& path, uint64_t limit,
                                               std::string& error) {
  std::error_code code;
  if (!fs::is_regular_file(path, code)) {
    error = fmt::format("{}: {}", path.string(),
                        fs::exists(path, code) ? "not a regular file" : "the file does not exist");
    return std::nullopt;
  }
  const uint64_t size = fs::file_size(path, code);
  if (code || size > limit) {
    error = code ? fmt::format("{}: cannot read the file: {}", path.string(), code.message())
                 : fmt::format("{}: the file has {} bytes; at most {} are read", path.string(),
                               size, limit);
    return std::nullopt;
  }
  const File file(std::fopen(path.c_str(), "rb"));
  std::vector<uint8_t> bytes(size);
  if (!file || std::fread(bytes.data(), 1, bytes.size(), file.get()) != bytes.size()) {
    error = fmt::format("{}: the file cannot be opened or read to its end: {}", path.string(),
                        last_error());
    return std::nullopt;
  }
  return bytes;
}

fs::path temporary_path(const fs::path& path) {
  static std::atomic<uint64_t> counter{0}; // makes names unique within the process
  fs::path result = path;
  result += fmt::format(".{}-{}.part", ::getpid(), counter.fetch_add(1));
  return result;
}

bool write_bytes(const fs::path& given, std::span<const uint8_t> bytes, std::string& error) {
  std::error_code code;
  const fs::file_status target = fs::status(given, code);
  if (fs::exists(target) && !fs::is_regular_file(target) && !fs::is_directory(target)) {
    // A device or a pipe takes the bytes; a rename would replace it.
    if (write_file(given, bytes)) return true;
    error = fmt::format("'{}' cannot be written: {}", given.string(), last_error());
    return false;
  }
  // A link stays: the file to which it leads is replaced.
  const fs::path linked = fs::is_symlink(given, code) ? fs::canonical(given, code) : fs::path();
  const fs::path& path = linked.empty() ? given : linked;
  const fs::path part = temporary_path(path);
  if (!write_file(part, bytes)) {
    error = fmt::format("'{}' cannot be written: {}", path.string(), last_error());
  } else {
    if (const fs::file_status old = fs::status(path, code); fs::is_regular_file(old))
      fs::permissions(part, old.permissions(), code);
    fs::rename(part, path, code);
    if (!code) return true;
    error = fmt::format("'{}' cannot be put in place: {}", path.string(), code.message());
  }
  fs::remove(part, code);
  return false;
}

bool write_text(const fs::path& path, std::string_view text, std::string& error) {
  return write_bytes(path, {reinterpret_cast<const uint8_t*>(text.data()), text.size()}, error);
}

} // namespace dermis::tools
