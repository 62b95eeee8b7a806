#pragma once
// Simplifies SPIR-V modules for SwiftShader, whose compiler takes exponential time otherwise.

#include <cstdint>
#include <span>
#include <vector>
#include <vulkan/vulkan_core.h>

namespace dermis::vulkan {

bool is_swiftshader(const VkPhysicalDeviceProperties& device);

// Returns the module with
// - "do not unroll" instead of every unroll hint, because SwiftShader unrolls without limit: it
//   compiled subsurface_classify (five loops of 16 steps) for minutes in 24 GiB of memory;
// - jumps instead of branches on specialization constants of type bool, with the values of
//   `constants`, because SwiftShader keeps both sides, and its search for paths through the body of
//   a loop visits a block twice as often after each branch: subsurface_sap_gather took 66 s. A branch
//   stays if the target that it would lose has an OpPhi, which names the block of the branch.
// Input that is not SPIR-V is returned unchanged. Free-threaded.
std::vector<uint32_t> simplify_for_swiftshader(std::span<const uint32_t> spirv,
                                               const VkSpecializationInfo& constants);

} // namespace dermis::vulkan
