#include "integration/examples/demo_engine/files.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>

namespace demo {

Result<std::vector<std::byte>> read_binary_file(const std::string& path, uint64_t maximum) {
  std::error_code problem;
  const auto status = std::filesystem::status(path, problem);
  if (problem || !std::filesystem::exists(status))
    return Error{ErrorKind::input, fmt::format("{}: the file does not exist", path)};
  if (!std::filesystem::is_regular_file(status))
    return Error{ErrorKind::input, fmt::format("{}: not a regular file", path)};
  const uint64_t size = std::filesystem::file_size(path, problem);
  if (problem)
    return Error{ErrorKind::input,
                 fmt::format("{}: cannot read the file: {}", path, problem.message())};
  if (size > maximum)
    return Error{ErrorKind::input, fmt::format("{}: the file has {} bytes; at most {} are read",
                                               path, size, maximum)};
  std::ifstream stream(path, std::ios::binary);
  std::vector<std::byte> bytes(size);
  stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
  if (!stream)
    return Error{ErrorKind::input,
                 fmt::format("{}: the file cannot be opened or read to its end", path)};
  return bytes;
}

Result<std::string> read_text_file(const std::string& path) {
  constexpr uint64_t maximum = uint64_t{16} << 20;
  auto bytes = read_binary_file(path, maximum);
  if (!bytes) return bytes.error();
  return std::string(reinterpret_cast<const char*>(bytes->data()), bytes->size());
}

} // namespace demo
