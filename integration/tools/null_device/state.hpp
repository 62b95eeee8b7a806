#pragma once
// What the functions of the null device share. Dispatchable handles are pointers to the state, the others are
// pointers to an Object.

#include "integration/tools/null_device/null_device.hpp"

#include <atomic>
#include <cstddef>
#include <memory>
#include <mutex>
#include <unordered_set>

namespace dermis {

struct NullObject {
  VkMemoryRequirements needs{};          // of images and buffers
  uint64_t bytes = 0;                    // of memory
  std::unique_ptr<std::byte[]> contents; // of mapped memory
};

struct NullDeviceState {
  // Loaders put a pointer there, layers look for it.
  void* dispatch = nullptr;
  std::atomic<uint64_t> commands = 0, barriers = 0;
  std::atomic<VkResult> query_failure = VK_SUCCESS;
  std::atomic<VkQueueFlags> queue_flags =
      VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT | VK_QUEUE_TRANSFER_BIT;
  std::mutex mutex; // guards all that follows
  uint64_t memory_bytes = 0, creations = 0;
  uint64_t failing_creation = 0;
  VkResult failure = VK_SUCCESS;
  std::unordered_set<NullObject*> alive;
  ~NullDeviceState();
};

template <class Handle> NullDeviceState& state_of(Handle dispatchable) {
  return *reinterpret_cast<NullDeviceState*>(dispatchable);
}

template <class Handle> NullObject& object_of(Handle handle) {
  return *reinterpret_cast<NullObject*>(handle);
}

// VK_SUCCESS, or the failure that was asked for.
VkResult count_creation(NullDeviceState& state);
NullObject* add_object(NullDeviceState& state, uint64_t memory_bytes = 0);
void remove_object(NullDeviceState& state, NullObject* object);

// The entry points; null for a name that is unknown.
PFN_vkVoidFunction object_function(const char* name);
PFN_vkVoidFunction command_function(const char* name);
PFN_vkVoidFunction query_function(const char* name);

// One name and its function.
struct NullEntry {
  const char* name;
  PFN_vkVoidFunction function;
};

template <class Function> NullEntry entry(const char* name, Function function) {
  return {name, reinterpret_cast<PFN_vkVoidFunction>(function)};
}

PFN_vkVoidFunction find_entry(const NullEntry* entries, size_t count, const char* name);

} // namespace dermis
