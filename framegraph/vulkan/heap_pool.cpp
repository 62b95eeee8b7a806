#include "framegraph/vulkan/heap_pool.hpp"

#include "framegraph/vulkan/device_memory.hpp"

#include <algorithm>

namespace dermis::vulkan {

Error HeapPool::create(const Device& device, std::span<const Plan* const> plans,
                       HistoryMemory histories, std::unique_ptr<HeapPool>& pool) {
  std::unique_ptr<HeapPool> made(new HeapPool(device));
  made->plans_.assign(plans.begin(), plans.end());
  made->shared_ = share_heaps(plans, histories, [&](const Plan& plan, uint32_t heap) {
    return std::max(plan.heaps[heap].alignment, heap_alignment(device, plan, heap));
  });
  for (const SharedBlock& shared : made->shared_.blocks) {
    Block& block = made->blocks_.emplace_back();
    block.request = {shared.history ? MemoryPurpose::history : MemoryPurpose::transient,
                     shared.memory_type_bits,
                     shared.bytes,
                     shared.alignment,
                     0,
                     VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT};
    if (Error error = allocate_memory(device, block.request, "shared heap", block.memory))
      return error;
  }
  pool = std::move(made);
  return {};
}

HeapPool::~HeapPool() {
  for (const Block& block : blocks_)
    free_memory(*device_, block.memory);
}

bool HeapPool::has(const Plan& plan) const noexcept {
  return std::find(plans_.begin(), plans_.end(), &plan) != plans_.end();
}

std::optional<MemoryBlock> HeapPool::find(const Plan& plan, uint32_t heap) const noexcept {
  const auto at = std::find(plans_.begin(), plans_.end(), &plan);
  if (at == plans_.end()) return std::nullopt;
  const SharedPlace& place = shared_.places[static_cast<size_t>(at - plans_.begin())][heap];
  if (place.block == no_block) return std::nullopt;
  MemoryBlock memory = blocks_[place.block].memory;
  memory.offset += place.offset;
  return memory;
}

} // namespace dermis::vulkan
