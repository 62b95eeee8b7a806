#pragma once
// Hints on loops in a SPIR-V module, for drivers that follow them into the ground.

#include <cstdint>
#include <span>
#include <vector>
#include <vulkan/vulkan_core.h>

namespace dermis::vulkan {

// Does the device take hints to unroll so far that it cannot be done? SwiftShader does: of
// subsurface_classify, five loops of 16 steps, it made code for minutes in 24 GiB of memory, and in .1 s
// without.
bool unrolls_without_end(const VkPhysicalDeviceProperties& device);

// The module with every loop that asks to be unrolled asking not to be. What is not SPIR-V comes back as it
// is. Free-threaded.
std::vector<uint32_t> without_unrolling(std::span<const uint32_t> spirv);

} // namespace dermis::vulkan
