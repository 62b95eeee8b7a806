#pragma once
// A glTF file as tinygltf has it, after what that library does not look at was checked.

#include "integration/examples/demo_engine/result.hpp"

#include <tiny_gltf.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace demo {

inline constexpr uint64_t max_model_bytes = uint64_t{1} << 30; // of a file or a buffer beside it

// `path` names the file in messages; buffers and pictures that it names are read from its folder and from
// below `roots` (dermis::place_file). Pictures stay encoded; one whose bytes are not there is empty. Errors:
// input.
Result<tinygltf::Model> parse_gltf(const std::string& path, std::span<const std::byte> bytes,
                                   const std::vector<std::string>& roots);

} // namespace demo
