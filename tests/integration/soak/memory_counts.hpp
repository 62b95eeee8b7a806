#pragma once
// Host allocators that count their live blocks.

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

// Memory of this process after free memory was returned to the system; 0 if unknown.
struct ProcessMemory {
  int64_t resident = 0, heap = 0; // Bytes; `heap` counts blocks in use.
  // Bytes of executable mappings without a file: kernels that drivers compiled.
  int64_t compiled = 0;
};
ProcessMemory process_memory();

} // namespace dermis::abi_test
