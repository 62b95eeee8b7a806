#pragma once
// Text files that tests read and change.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>

namespace dermis::test {

// Returns the contents of the file; "" if it cannot be read, as a folder.
inline std::string read_text(const std::filesystem::path& path) {
  if (std::filesystem::is_directory(path)) return {};
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// Returns the text with the first occurrence of `from` replaced; fails the test if there is none.
inline std::string replaced(std::string text, std::string_view from, std::string_view to) {
  const size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << "no " << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

} // namespace dermis::test
