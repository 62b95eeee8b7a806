#pragma once
// Whole files into memory, with limits and messages that name them.

#include "integration/examples/demo_engine/result.hpp"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace demo {

// Errors: input (absent, not a regular file, larger than `most` bytes, unreadable).
Result<std::vector<std::byte>> read_binary_file(const std::string& path, uint64_t maximum);
// At most 16 MiB, as the library itself accepts.
Result<std::string> read_text_file(const std::string& path);

} // namespace demo
