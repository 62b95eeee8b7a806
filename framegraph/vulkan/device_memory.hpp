#pragma once
// Allocates device memory from Vulkan or from the host's allocator, and hides which of them is
// used.

#include "framegraph/vulkan/device.hpp"

#include <string>

namespace dermis {
struct Plan;
}

namespace dermis::vulkan {

// Allocates from a type among `request.memory_types` that has all required properties; types with
// the preferred properties come first. `object` names the memory in messages. Errors:
// unsupported (no such type), device_memory, host_memory, device_lost, vulkan; `block` is then
// unchanged. Free-threaded.
Error allocate_memory(const Device& device, const MemoryRequest& request, const std::string& object,
                      MemoryBlock& block);
// Returns whether a memory type among `memory_types` has all of the properties. Free-threaded.
bool has_memory_type(const Device& device, uint32_t memory_types, VkMemoryPropertyFlags properties);
// Frees the block; does nothing if the block is empty. Free-threaded.
void free_memory(const Device& device, const MemoryBlock& block);

// Returns the alignment in bytes that every image and buffer in heap `heap` of the plan needs.
// Free-threaded.
uint64_t heap_alignment(const Device& device, const Plan& plan, uint32_t heap);

} // namespace dermis::vulkan
