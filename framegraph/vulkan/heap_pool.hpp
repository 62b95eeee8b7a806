#pragma once
// Holds memory that several plans of one view use in turn. Transients of plans that never run in
// the same frame share the same bytes.

#include "framegraph/compile/plan.hpp"
#include "framegraph/vulkan/device.hpp"
#include "framegraph/vulkan/error.hpp"

#include <memory>
#include <span>
#include <vector>

namespace dermis::vulkan {

class HeapPool {
public:
  // Allocates one block for each set of memory types that transient heaps of the plans use; its
  // size is that of the largest heap. Errors: unsupported, device_memory, host_memory, vulkan;
  // `pool` is then unchanged. `device` must outlive the pool.
  static Error create(const Device& device, std::span<const Plan* const> plans,
                      std::unique_ptr<HeapPool>& pool);
  ~HeapPool(); // All executors that use the pool must be destroyed before it.

  struct Block {
    MemoryRequest request;
    MemoryBlock memory;
  };
  // Returns null if no plan given to create() has a transient heap with these memory types.
  const Block* find(uint32_t memory_type_bits) const noexcept;
  std::span<const Block> blocks() const noexcept { return blocks_; }
  uint64_t bytes() const noexcept;

  HeapPool(const HeapPool&) = delete;
  HeapPool& operator=(const HeapPool&) = delete;

private:
  explicit HeapPool(const Device& device) : device_(&device) {}
  const Device* device_;
  std::vector<Block> blocks_;
};

} // namespace dermis::vulkan
