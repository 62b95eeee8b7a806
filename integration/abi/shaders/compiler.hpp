#pragma once
// Compiles kernels from GLSL at run time. Either glslang_compiler.cpp or no_compiler.cpp is linked.

#include "framegraph/compose/compose.hpp"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace dermis::abi {

// Returns e.g. "glslang 12.0.0"; "" if this build has no compiler. Free-threaded.
std::string shader_compiler();

// Compiles each kernel of `shaders` (PassType::shader) from "NAME.comp" and its includes. #include
// "FILE" calls `open`, except for headers generated from signatures (*.bindings.glsl,
// constants.glsl, options.glsl), which the library provides. Names that leave the folder are
// rejected before `open` is called. spirv[i] is empty if `open` has no such kernel. Returns false
// with the errors of all kernels in `diagnostics`. Allocates from the C library. Free-threaded if
// `open` is.
bool compile_shaders(std::span<const std::string> shaders, const OpenFile& open,
                     std::vector<std::vector<uint32_t>>& spirv, Diagnostics& diagnostics);

} // namespace dermis::abi
