#pragma once
// Parses a glTF file with tinygltf, after checks that tinygltf does not make.

#include "integration/examples/demo_engine/result.hpp"

#include <tiny_gltf.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace demo {

// limit of a file or of a separate buffer
inline constexpr uint64_t max_model_bytes = uint64_t{1} << 30;

// Parses a file. `path` names the file in messages. Buffers and pictures that the file names are
// read from its folder and from below `roots` (dermis::place_file). Pictures stay encoded; a
// missing picture is empty. Errors: input.
Result<tinygltf::Model> parse_gltf(const std::string& path, std::span<const std::byte> bytes,
                                   const std::vector<std::string>& roots);

} // namespace demo
