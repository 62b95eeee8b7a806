#pragma once
// Allocators of a host that count what they have handed out.

#include "integration/examples/demo_engine/vulkan_host.hpp"

#include <dermis/dermis.h>

#include <atomic>
#include <cstdint>

namespace dermis::abi_test {

struct CountedHeap {
  std::atomic<int64_t> blocks = 0, bytes = 0;
  dermis_allocator allocator();
};

struct CountedDeviceMemory {
  demo::VulkanHost& host;
  int64_t blocks = 0, bytes = 0, max_bytes = 0;
  dermis_device_allocator allocator();
};

// Of this process, once what is free is given back to the system; 0 where it cannot be told.
struct ProcessMemory {
  int64_t resident = 0, heap = 0; // bytes; of the heap those in use
  int64_t compiled = 0;           // bytes of executable mappings of no file: kernels that drivers compiled
};
ProcessMemory process_memory();

} // namespace dermis::abi_test
