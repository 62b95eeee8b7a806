#pragma once
// Kernels from GLSL text while the program runs. Of glslang_compiler.cpp and no_compiler.cpp one is linked.

#include "framegraph/compose/compose.hpp"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace dermis::abi {

// "glslang 12.0.0"; "" where this build has none. Free-threaded.
std::string shader_compiler();

// Compiles each kernel of `shaders` (PassType::shader) from "NAME.comp" and from what that includes:
// "FILE" of `open` for #include "FILE", but for headers that come from signatures (*.bindings.glsl,
// constants.glsl), which are the library's. Names that lead out are refused before `open` is asked. spirv[i]
// is empty where `open` has no such kernel. False with errors of all kernels in `diagnostics`. Takes its
// memory from the C library. Free-threaded if `open` is.
bool compile_shaders(std::span<const std::string> shaders, const OpenFile& open,
                     std::vector<std::vector<uint32_t>>& spirv, Diagnostics& diagnostics);

} // namespace dermis::abi
