#include "framegraph/vulkan/heap_pool.hpp"

#include "framegraph/vulkan/executor/state.hpp"

#include <algorithm>

namespace dermis::vulkan {

Error HeapPool::create(const Device& device, std::span<const Plan* const> plans,
                       std::unique_ptr<HeapPool>& pool) {
  std::unique_ptr<HeapPool> made(new HeapPool(device));
  for (const Plan* plan : plans)
    for (const Heap& heap : plan->heaps) {
      if (heap.persistent) continue;
      auto at = std::find_if(made->blocks_.begin(), made->blocks_.end(), [&](const Block& block) {
        return block.memory_type_bits == heap.memory_type_bits;
      });
      if (at == made->blocks_.end())
        at = made->blocks_.insert(at, {heap.memory_type_bits, 0, VK_NULL_HANDLE});
      at->bytes = std::max(at->bytes, heap.size);
    }
  for (Block& block : made->blocks_)
    if (Error error =
            allocate_heap(device, block.memory_type_bits, block.bytes, "shared transient heap", block.memory))
      return error;
  pool = std::move(made);
  return {};
}

HeapPool::~HeapPool() {
  for (const Block& block : blocks_)
    device_->vk.vkFreeMemory(device_->device, block.memory, device_->allocator);
}

VkDeviceMemory HeapPool::find(uint32_t memory_type_bits) const noexcept {
  for (const Block& block : blocks_)
    if (block.memory_type_bits == memory_type_bits) return block.memory;
  return VK_NULL_HANDLE;
}

uint64_t HeapPool::bytes() const noexcept {
  uint64_t sum = 0;
  for (const Block& block : blocks_)
    sum += block.bytes;
  return sum;
}

} // namespace dermis::vulkan
