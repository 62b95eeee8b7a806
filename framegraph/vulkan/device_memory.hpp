#pragma once
// Device memory: taken from Vulkan, or from a host that has heaps of its own. Which of them, only this file
// knows.

#include "framegraph/vulkan/device.hpp"

#include <string>

namespace dermis {
struct Plan;
}

namespace dermis::vulkan {

// A type of device memory among `request.memory_types` with its required properties, and if there is one with
// the preferred ones too. `thing` is for messages. Errors: unsupported (no such type), device_memory,
// host_memory, device_lost, vulkan; then `block` is unchanged. Free-threaded.
Error take_memory(const Device& device, const MemoryRequest& request, const std::string& subresource,
                  MemoryBlock& block);
// Nothing where the block is empty. Free-threaded.
void give_back_memory(const Device& device, const MemoryBlock& block);

// What every image and buffer that the plan places in heap `heap` wants its offset to be a multiple of.
// Free-threaded.
uint64_t heap_alignment(const Device& device, const Plan& plan, uint32_t heap);

} // namespace dermis::vulkan
