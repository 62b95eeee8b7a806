#pragma once
// Reads numbers from a glTF file's buffers. Every index and size is checked first.

#include "integration/examples/demo_engine/result.hpp"

#include <tiny_gltf.h>

#include <cstdint>
#include <string>
#include <vector>

namespace demo {

// Returns count x `width` floats of accessor `index`; integers are normalised if the file says so.
// Errors: input; the text names the accessor of `file` and the fault.
Result<std::vector<float>> read_floats(const tinygltf::Model& model, const std::string& file,
                                       int index, int type, uint32_t width);
// Returns unsigned integers, each below `limit`. Errors: as above.
Result<std::vector<uint32_t>> read_indices(const tinygltf::Model& model, const std::string& file,
                                           int index, uint32_t limit);

} // namespace demo
