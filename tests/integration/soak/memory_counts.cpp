#include "tests/integration/soak/memory_counts.hpp"

#include <algorithm>
#include <bit>
#include <cstdlib>
#include <fstream>
#include <string>
#include <unistd.h>
// A function of the sanitizer's runtime; gcc has no header that declares it.
#ifdef DERMIS_ADDRESS_SANITIZER
extern "C" size_t __sanitizer_get_current_allocated_bytes(void);
#elif defined(__GLIBC__)
#include <malloc.h>
#endif

namespace dermis::abi_test {
namespace {

void* DERMIS_CALL allocate(void* user, size_t size, size_t alignment) {
  auto& heap = *static_cast<CountedHeap*>(user);
  ++heap.blocks;
  heap.bytes += static_cast<int64_t>(size);
  return std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
}

void DERMIS_CALL release(void* user, void* memory, size_t size, size_t) {
  auto& heap = *static_cast<CountedHeap*>(user);
  --heap.blocks;
  heap.bytes -= static_cast<int64_t>(size);
  std::free(memory);
}

VkResult DERMIS_CALL take(void* user, const dermis_memory_request* request,
                          dermis_memory_block* out) {
  auto& counted = *static_cast<CountedDeviceMemory*>(user);
  VkPhysicalDeviceMemoryProperties properties;
  vkGetPhysicalDeviceMemoryProperties(counted.host.physical_device, &properties);
  const VkMemoryPropertyFlags required_flags[] = {request->required | request->preferred,
                                                  request->required};
  for (const VkMemoryPropertyFlags flags : required_flags)
    for (uint32_t type = 0; type < properties.memoryTypeCount; ++type) {
      const VkMemoryPropertyFlags has = properties.memoryTypes[type].propertyFlags;
      if ((request->memory_types >> type & 1u) == 0 || (has & flags) != flags) continue;
      auto info = demo::vulkan_struct<VkMemoryAllocateInfo>(VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO);
      info.allocationSize = request->bytes;
      info.memoryTypeIndex = type;
      VkResult result =
          counted.host.vk.vkAllocateMemory(counted.host.device, &info, nullptr, &out->memory);
      if (result != VK_SUCCESS) return result;
      if ((has & VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT) != 0)
        result = counted.host.vk.vkMapMemory(counted.host.device, out->memory, 0, VK_WHOLE_SIZE, 0,
                                             &out->mapped);
      out->offset = 0;
      out->user = std::bit_cast<void*>(static_cast<uintptr_t>(request->bytes));
      ++counted.blocks;
      counted.bytes += static_cast<int64_t>(request->bytes);
      counted.max_bytes = std::max(counted.max_bytes, counted.bytes);
      return result;
    }
  return VK_ERROR_OUT_OF_DEVICE_MEMORY;
}

void DERMIS_CALL give_back(void* user, const dermis_memory_block* block) {
  auto& counted = *static_cast<CountedDeviceMemory*>(user);
  --counted.blocks;
  counted.bytes -= static_cast<int64_t>(std::bit_cast<uintptr_t>(block->user));
  counted.host.vk.vkFreeMemory(counted.host.device, block->memory, nullptr);
}

} // namespace

dermis_allocator CountedHeap::allocator() {
  dermis_allocator out = DERMIS_ALLOCATOR_INIT;
  out.allocate = allocate;
  out.free = release;
  out.user = this;
  return out;
}

dermis_device_allocator CountedDeviceMemory::allocator() {
  dermis_device_allocator out = DERMIS_DEVICE_ALLOCATOR_INIT;
  out.allocate = take;
  out.free = give_back;
  out.user = this;
  return out;
}

ProcessMemory process_memory() {
  ProcessMemory out;
#ifdef DERMIS_ADDRESS_SANITIZER
  out.heap = static_cast<int64_t>(__sanitizer_get_current_allocated_bytes());
#elif defined(__GLIBC__)
  malloc_trim(0);
  const struct mallinfo2 reported = mallinfo2();
  out.heap = static_cast<int64_t>(reported.uordblks + reported.hblkhd);
#endif
// The sanitizer keeps up to 256 MiB of freed blocks, to detect their use.
#ifndef DERMIS_ADDRESS_SANITIZER
  int64_t pages = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> pages >> resident;
  out.resident = resident * static_cast<int64_t>(sysconf(_SC_PAGESIZE));
#endif
  std::ifstream maps("/proc/self/maps");
  for (std::string line; std::getline(maps, line);) {
    if (line.find(" r-xp ") == std::string::npos || line.find_first_of("/[") != std::string::npos)
      continue;
    const std::string end = line.substr(line.find('-') + 1);
    out.compiled +=
        static_cast<int64_t>(std::stoull(end, nullptr, 16) - std::stoull(line, nullptr, 16));
  }
  return out;
}

} // namespace dermis::abi_test
