#include "integration/abi/memory/device_memory.hpp"

namespace dermis::abi {
namespace {

VkResult allocate_block(void* allocator, const vulkan::MemoryRequest& request,
                        vulkan::MemoryBlock& block) {
  const auto& host = *static_cast<const DeviceAllocator*>(allocator);
  const dermis_memory_request host_request = request_of(request);
  dermis_memory_block given = DERMIS_MEMORY_BLOCK_INIT;
  try {
    const VkResult result = host.allocate(host.user, &host_request, &given);
    if (result != VK_SUCCESS) return result;
  } catch (...) { // exceptions of a C++ host
    return VK_ERROR_UNKNOWN;
  }
  block = {given.memory, given.offset, given.mapped, given.user};
  return VK_SUCCESS;
}

void free_block(void* allocator, const vulkan::MemoryBlock& block) {
  const auto& host = *static_cast<const DeviceAllocator*>(allocator);
  dermis_memory_block given = DERMIS_MEMORY_BLOCK_INIT;
  given.memory = block.memory;
  given.offset = block.offset;
  given.mapped = block.mapped;
  given.user = block.user;
  try {
    host.free(host.user, &given);
  } catch (...) { // nothing is left to be done about it
    return;
  }
}

} // namespace

vulkan::HostMemory host_memory_of(DeviceAllocator& allocator) {
  if (allocator.allocate == nullptr) return {};
  return {allocate_block, free_block, &allocator};
}

dermis_memory_request request_of(const vulkan::MemoryRequest& request) {
  dermis_memory_request out = DERMIS_MEMORY_REQUEST_INIT;
  switch (request.purpose) {
  case vulkan::MemoryPurpose::transient:
    out.purpose = DERMIS_MEMORY_TRANSIENT;
    break;
  case vulkan::MemoryPurpose::history:
    out.purpose = DERMIS_MEMORY_HISTORY;
    break;
  case vulkan::MemoryPurpose::constants:
    out.purpose = DERMIS_MEMORY_CONSTANTS;
    break;
  }
  out.memory_types = request.memory_types;
  out.bytes = request.bytes;
  out.alignment = request.alignment;
  out.required = request.required;
  out.preferred = request.preferred;
  return out;
}

} // namespace dermis::abi
