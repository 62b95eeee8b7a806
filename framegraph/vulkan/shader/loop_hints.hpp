#pragma once
// Removes unroll hints from a SPIR-V module, for drivers that unroll without limit.

#include <cstdint>
#include <span>
#include <vector>
#include <vulkan/vulkan_core.h>

namespace dermis::vulkan {

// Returns whether the device unrolls loops with hints without limit. SwiftShader does: it compiled
// subsurface_classify (five loops of 16 steps) for minutes in 24 GiB of memory, and in 0.1 s
// without hints.
bool unrolls_without_end(const VkPhysicalDeviceProperties& device);

// Returns the module with every unroll hint replaced by a "do not unroll" hint. Input that is not
// SPIR-V is returned unchanged. Free-threaded.
std::vector<uint32_t> without_unrolling(std::span<const uint32_t> spirv);

} // namespace dermis::vulkan
