#pragma once
// Numbers out of a glTF file's buffers, with every index and size checked first.

#include "integration/examples/demo_engine/result.hpp"

#include <tiny_gltf.h>

#include <cstdint>
#include <string>
#include <vector>

namespace demo {

// `count` x `width` floats of accessor `index`; integers are normalised where the file says so.
// Errors: input; the text says which accessor of `file` is wrong and why.
Result<std::vector<float>> read_floats(const tinygltf::Model& model, const std::string& file, int index,
                                       int type, uint32_t width);
// Unsigned integers, each below `limit`. Errors: as above.
Result<std::vector<uint32_t>> read_indices(const tinygltf::Model& model, const std::string& file, int index,
                                           uint32_t limit);

} // namespace demo
