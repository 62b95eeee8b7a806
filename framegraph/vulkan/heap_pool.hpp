#pragma once
// Holds memory that several plans of one view use in turn.

#include "framegraph/compile/shared_heaps.hpp"
#include "framegraph/vulkan/device.hpp"
#include "framegraph/vulkan/error.hpp"

#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace dermis::vulkan {

class HeapPool {
public:
  // Allocates the blocks of share_heaps(). Errors: unsupported, device_memory, host_memory, vulkan;
  // `pool` is then unchanged. `device` and the plans must outlive the pool.
  static Error create(const Device& device, std::span<const Plan* const> plans,
                      HistoryMemory histories, std::unique_ptr<HeapPool>& pool);
  ~HeapPool(); // All executors that use the pool must be destroyed before it.

  struct Block {
    MemoryRequest request;
    MemoryBlock memory;
  };
  // Returns whether the pool was created for the plan.
  bool has(const Plan& plan) const noexcept;
  // Returns the memory of a heap of the plan; nullopt if the heap needs memory of its own.
  std::optional<MemoryBlock> find(const Plan& plan, uint32_t heap) const noexcept;
  std::span<const Block> blocks() const noexcept { return blocks_; }
  // Sizes of all heaps of the plans, in the pool or not.
  uint64_t transient_bytes() const noexcept { return shared_.transient_bytes; }
  uint64_t history_bytes() const noexcept { return shared_.history_bytes; }

  HeapPool(const HeapPool&) = delete;
  HeapPool& operator=(const HeapPool&) = delete;

private:
  explicit HeapPool(const Device& device) : device_(&device) {}
  const Device* device_;
  std::vector<const Plan*> plans_;
  SharedHeaps shared_;
  std::vector<Block> blocks_;
};

} // namespace dermis::vulkan
