#pragma once
// Reads whole files into memory, with limits and messages that name the file.

#include "integration/examples/demo_engine/result.hpp"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace demo {

// Errors: input (absent, not a regular file, larger than `maximum` bytes, unreadable).
Result<std::vector<std::byte>> read_binary_file(const std::string& path, uint64_t maximum);
// Reads at most 16 MiB, the limit of the library itself.
Result<std::string> read_text_file(const std::string& path);

} // namespace demo
