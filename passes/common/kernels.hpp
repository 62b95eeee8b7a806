#pragma once
// The SPIR-V of the kernels, embedded at build time.

#include <cstdint>
#include <span>
#include <string_view>

namespace dermis {

struct Kernel {
  std::string_view shader; // PassType::shader
  std::span<const uint32_t> spirv;
};

// Returns all kernels, in the order of the build's shader list. Static memory. Thread: any.
std::span<const Kernel> embedded_kernels();
// Returns an empty span for an unknown name.
std::span<const uint32_t> find_kernel(std::string_view shader);

} // namespace dermis
