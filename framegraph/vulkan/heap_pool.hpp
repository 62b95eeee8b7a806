#pragma once
// Memory that several plans of one view use in turn: transients of plans that never run in the same frame lie
// in the same bytes.

#include "framegraph/compile/plan.hpp"
#include "framegraph/vulkan/device.hpp"
#include "framegraph/vulkan/error.hpp"

#include <memory>
#include <span>
#include <vector>

namespace dermis::vulkan {

class HeapPool {
public:
  // One block for each set of memory types that transient heaps of the plans ask for, as large as the
  // largest. Errors: unsupported, device_memory, host_memory, vulkan; then `pool` is unchanged. `device` must
  // outlive it.
  static Error create(const Device& device, std::span<const Plan* const> plans,
                      std::unique_ptr<HeapPool>& pool);
  ~HeapPool(); // after all executors that use it

  struct Block {
    MemoryRequest request;
    MemoryBlock memory;
  };
  // Null where no plan given to create() has a transient heap of these types.
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
