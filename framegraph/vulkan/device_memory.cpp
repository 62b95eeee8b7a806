#include "framegraph/vulkan/device_memory.hpp"

#include "framegraph/compile/plan.hpp"
#include "framegraph/vulkan/create_infos.hpp"

#include <algorithm>
#include <fmt/core.h>
#include <optional>

namespace dermis::vulkan {
namespace {

// Excludes memory types with properties that ordinary memory must not have.
constexpr VkMemoryPropertyFlags special_memory =
    VK_MEMORY_PROPERTY_LAZILY_ALLOCATED_BIT | VK_MEMORY_PROPERTY_PROTECTED_BIT |
    VK_MEMORY_PROPERTY_DEVICE_COHERENT_BIT_AMD | VK_MEMORY_PROPERTY_DEVICE_UNCACHED_BIT_AMD;

// Returns the first type that has all required and preferred properties, else the first with the
// required ones.
std::optional<uint32_t> choose_type(const Device& device, const MemoryRequest& request) {
  std::optional<uint32_t> fallback;
  for (uint32_t i = 0; i < device.memory.memoryTypeCount; ++i) {
    const VkMemoryPropertyFlags flags = device.memory.memoryTypes[i].propertyFlags;
    if ((request.memory_types >> i & 1u) == 0 || (flags & request.required) != request.required ||
        (flags & special_memory) != 0)
      continue;
    if ((flags & request.preferred) == request.preferred) return i;
    if (!fallback) fallback = i;
  }
  return fallback;
}

Error allocate_from_host(const Device& device, const MemoryRequest& request,
                         const std::string& object, MemoryBlock& block) {
  MemoryBlock given;
  const VkResult result = device.host_memory.allocate(device.host_memory.user, request, given);
  if (result != VK_SUCCESS)
    return call_error(result, "the host's allocator",
                      fmt::format("{}, {} bytes", object, request.bytes));
  const bool unmapped =
      (request.required & VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT) != 0 && given.mapped == nullptr;
  if (given.memory != VK_NULL_HANDLE && given.offset % request.alignment == 0 && !unmapped) {
    block = given;
    return {};
  }
  if (given.memory != VK_NULL_HANDLE) free_memory(device, given);
  return {ErrorKind::allocator, VK_SUCCESS,
          fmt::format("{}: the host's allocator returned {}", object,
                      given.memory == VK_NULL_HANDLE ? std::string("no memory")
                      : unmapped                     ? std::string("memory that is not mapped")
                                 : fmt::format("offset {}, which is not a multiple of {}",
                                               given.offset, request.alignment))};
}

} // namespace

Error allocate_memory(const Device& device, const MemoryRequest& request, const std::string& object,
                      MemoryBlock& block) {
  if (device.host_memory.allocate != nullptr)
    return allocate_from_host(device, request, object, block);
  // Memory that is device-local and visible to the host may be a small heap of its own, and full.
  // Other memory that the host sees is then slower, but sufficient.
  const bool may_retry = (request.required & VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT) != 0;
  MemoryRequest untried = request;
  MemoryBlock taken;
  Error failed; // with the best type
  VkResult result = VK_ERROR_OUT_OF_DEVICE_MEMORY;
  do {
    const auto type = choose_type(device, untried);
    if (!type && failed) return failed;
    if (!type)
      return {ErrorKind::unsupported, VK_SUCCESS,
              fmt::format("{}: the device has no memory type among {:#x}", object,
                          request.memory_types)};
    untried.memory_types &= ~(1u << *type);
    const VkMemoryType& memory_type = device.memory.memoryTypes[*type];
    if (failed && device.memory.memoryHeaps[memory_type.heapIndex].size < request.bytes) continue;
    VkMemoryAllocateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO;
    info.allocationSize = request.bytes;
    info.memoryTypeIndex = *type;
    result = device.vk.vkAllocateMemory(device.device, &info, device.allocator, &taken.memory);
    if (result == VK_SUCCESS || (failed && result == VK_ERROR_OUT_OF_DEVICE_MEMORY)) continue;
    failed =
        call_error(result, "vkAllocateMemory",
                   fmt::format("{}, {} bytes of memory type {}", object, request.bytes, *type));
  } while (result == VK_ERROR_OUT_OF_DEVICE_MEMORY && may_retry);
  if (result != VK_SUCCESS) return failed;
  if ((request.required & VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT) != 0) {
    result = device.vk.vkMapMemory(device.device, taken.memory, 0, VK_WHOLE_SIZE, 0, &taken.mapped);
    if (result != VK_SUCCESS) {
      free_memory(device, taken);
      return call_error(result, "vkMapMemory", object);
    }
  }
  name_object(device, VK_OBJECT_TYPE_DEVICE_MEMORY, reinterpret_cast<uint64_t>(taken.memory),
              object.c_str());
  block = taken;
  return {};
}

bool has_memory_type(const Device& device, uint32_t memory_types,
                     VkMemoryPropertyFlags properties) {
  MemoryRequest request;
  request.memory_types = memory_types;
  request.required = properties;
  return choose_type(device, request).has_value();
}

void free_memory(const Device& device, const MemoryBlock& block) {
  if (device.host_memory.allocate == nullptr)
    device.vk.vkFreeMemory(device.device, block.memory, device.allocator); // unmaps
  else if (block.memory != VK_NULL_HANDLE)
    device.host_memory.free(device.host_memory.user, block);
}

uint64_t heap_alignment(const Device& device, const Plan& plan, uint32_t heap) {
  uint64_t alignment = 1;
  for (const PlanResource& resource : plan.resources) {
    if (resource.first_instance == no_instance ||
        plan.placements[resource.first_instance].heap != heap)
      continue;
    VkMemoryRequirements2 needs{};
    needs.sType = VK_STRUCTURE_TYPE_MEMORY_REQUIREMENTS_2;
    if (resource.type == ResourceType::image) {
      const VkImageCreateInfo info =
          image_create_info({resource.format, resource.width, resource.height, resource.mips,
                             resource.layers, resource.vk_usage});
      VkDeviceImageMemoryRequirements ask{};
      ask.sType = VK_STRUCTURE_TYPE_DEVICE_IMAGE_MEMORY_REQUIREMENTS;
      ask.pCreateInfo = &info;
      device.vk.vkGetDeviceImageMemoryRequirements(device.device, &ask, &needs);
    } else {
      const VkBufferCreateInfo info = buffer_create_info({resource.bytes, resource.vk_usage});
      VkDeviceBufferMemoryRequirements ask{};
      ask.sType = VK_STRUCTURE_TYPE_DEVICE_BUFFER_MEMORY_REQUIREMENTS;
      ask.pCreateInfo = &info;
      device.vk.vkGetDeviceBufferMemoryRequirements(device.device, &ask, &needs);
    }
    alignment = std::max(alignment, needs.memoryRequirements.alignment);
  }
  return std::max(alignment, device.properties.limits.bufferImageGranularity);
}

} // namespace dermis::vulkan
