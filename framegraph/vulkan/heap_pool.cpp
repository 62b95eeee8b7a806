#include "framegraph/vulkan/heap_pool.hpp"

#include "framegraph/vulkan/device_memory.hpp"

#include <algorithm>

namespace dermis::vulkan {

Error HeapPool::create(const Device& device, std::span<const Plan* const> plans,
                       std::unique_ptr<HeapPool>& pool) {
  std::unique_ptr<HeapPool> made(new HeapPool(device));
  for (const Plan* plan : plans)
    for (uint32_t h = 0; h < plan->heaps.size(); ++h) {
      const Heap& heap = plan->heaps[h];
      if (heap.persistent) continue;
      auto at = std::find_if(made->blocks_.begin(), made->blocks_.end(), [&](const Block& block) {
        return block.request.memory_types == heap.memory_type_bits;
      });
      if (at == made->blocks_.end()) {
        at = made->blocks_.emplace(at);
        at->request.memory_types = heap.memory_type_bits;
        at->request.preferred = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT;
      }
      at->request.bytes = std::max(at->request.bytes, heap.size);
      at->request.alignment = std::max(at->request.alignment, heap_alignment(device, *plan, h));
    }
  for (Block& block : made->blocks_)
    if (Error error = allocate_memory(device, block.request, "shared transient heap", block.memory))
      return error;
  pool = std::move(made);
  return {};
}

HeapPool::~HeapPool() {
  for (const Block& block : blocks_)
    give_back_memory(*device_, block.memory);
}

const HeapPool::Block* HeapPool::find(uint32_t memory_type_bits) const noexcept {
  for (const Block& block : blocks_)
    if (block.request.memory_types == memory_type_bits) return &block;
  return nullptr;
}

uint64_t HeapPool::bytes() const noexcept {
  uint64_t sum = 0;
  for (const Block& block : blocks_)
    sum += block.request.bytes;
  return sum;
}

} // namespace dermis::vulkan
