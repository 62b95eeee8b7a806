#pragma once
// Connects the host's device memory allocator in dermis.h to the executor.

#include "framegraph/vulkan/device.hpp"
#include "integration/include/dermis/dermis.h"

namespace dermis::abi {

struct DeviceAllocator {                        // copied from dermis_device_allocator
  dermis_allocate_memory_fn allocate = nullptr; // null: the library's own
  dermis_free_memory_fn free = nullptr;
  void* user = nullptr;
};

// `allocator` must live as long as the device.
vulkan::HostMemory host_memory_of(DeviceAllocator& allocator);
dermis_memory_request request_of(const vulkan::MemoryRequest& request);

} // namespace dermis::abi
