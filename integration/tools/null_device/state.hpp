#pragma once
// State shared by the functions of the null device. Dispatchable handles point to the state; other
// handles point to a NullObject.

#include "integration/tools/null_device/null_device.hpp"

#include <atomic>
#include <cstddef>
#include <memory>
#include <mutex>
#include <unordered_set>

namespace dermis {

struct NullObject {
  VkMemoryRequirements needs{};          // images and buffers
  uint64_t bytes = 0;                    // memory objects
  bool host_visible = true;              // memory objects
  std::unique_ptr<std::byte[]> contents; // mapped memory
};

struct NullDeviceState {
  // First member: loaders store a pointer here and layers read that pointer.
  void* dispatch = nullptr;
  std::atomic<uint64_t> commands = 0, barriers = 0, dispatches = 0, descriptor_writes = 0,
                        buffer_copies = 0, pipelines = 0;
  std::atomic<VkResult> query_failure = VK_SUCCESS;
  std::atomic<VkQueueFlags> queue_flags =
      VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT | VK_QUEUE_TRANSFER_BIT;
  std::atomic<bool> discrete = false; // device-local memory is not host-visible
  std::atomic<bool> full_bar = false; // with a full heap of memory that is both
  std::mutex mutex;                   // guards all following members
  uint64_t memory_bytes = 0, creations = 0;
  uint64_t failing_creation = 0;
  VkResult failure = VK_SUCCESS;
  std::unordered_set<NullObject*> alive;
  ~NullDeviceState();
};

// Memory types of a device whose device-local memory is not host-visible, except for a small heap.
inline constexpr uint32_t device_memory_type = 0, host_memory_type = 1, bar_memory_type = 2;
inline uint32_t memory_types(const NullDeviceState& state) {
  if (!state.discrete) return 1;
  return 1u << device_memory_type | 1u << host_memory_type |
         (state.full_bar ? 1u << bar_memory_type : 0u);
}

template <class Handle> NullDeviceState& state_of(Handle dispatchable) {
  return *reinterpret_cast<NullDeviceState*>(dispatchable);
}

template <class Handle> NullObject& object_of(Handle handle) {
  return *reinterpret_cast<NullObject*>(handle);
}

// Counts a creation. Returns VK_SUCCESS or the injected failure.
VkResult count_creation(NullDeviceState& state);
NullObject* add_object(NullDeviceState& state, uint64_t memory_bytes = 0);
void remove_object(NullDeviceState& state, NullObject* object);

// Return the entry point, or null for an unknown name.
PFN_vkVoidFunction object_function(const char* name);
PFN_vkVoidFunction command_function(const char* name);
PFN_vkVoidFunction query_function(const char* name);

struct NullEntry {
  const char* name;
  PFN_vkVoidFunction function;
};

template <class Function> NullEntry entry(const char* name, Function function) {
  return {name, reinterpret_cast<PFN_vkVoidFunction>(function)};
}

PFN_vkVoidFunction find_entry(const NullEntry* entries, size_t count, const char* name);

} // namespace dermis
