// Creates placeholders for unbound optional ports: zeroed images of 3x3 texels and a small zeroed
// buffer. The port mask tells the shader that a port is unbound; the placeholder only keeps the
// descriptor legal.
#include "framegraph/vulkan/create_infos.hpp"
#include "framegraph/vulkan/executor/state.hpp"

namespace dermis::vulkan {
namespace {

constexpr uint64_t placeholder_buffer_bytes =
    16; // the largest element a buffer block can start with

MemoryRequest request_of(const VkMemoryRequirements& needs) {
  return {MemoryPurpose::constants,           needs.memoryTypeBits, needs.size, needs.alignment, 0,
          VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT};
}

Error create_image(const Device& device, Placeholder& placeholder) {
  VkImageCreateInfo info = image_create_info({});
  info.extent = {3, 3, 1}; // llvmpipe recompiles a kernel if the sides are powers of two
  info.format = placeholder.format;
  info.usage = VK_IMAGE_USAGE_TRANSFER_DST_BIT |
               (placeholder.storage ? VK_IMAGE_USAGE_STORAGE_BIT : VK_IMAGE_USAGE_SAMPLED_BIT);
  VkResult result =
      device.vk.vkCreateImage(device.device, &info, device.allocator, &placeholder.image);
  if (result != VK_SUCCESS) {
    placeholder.image = VK_NULL_HANDLE;
    return call_error(result, "vkCreateImage", "placeholder of an unbound port");
  }
  name_object(device, VK_OBJECT_TYPE_IMAGE, reinterpret_cast<uint64_t>(placeholder.image),
              "placeholder image");
  VkMemoryRequirements needs{};
  device.vk.vkGetImageMemoryRequirements(device.device, placeholder.image, &needs);
  if (Error error =
          allocate_memory(device, request_of(needs), "placeholder image", placeholder.memory))
    return error;
  const VkBindImageMemoryInfo bind{VK_STRUCTURE_TYPE_BIND_IMAGE_MEMORY_INFO, nullptr,
                                   placeholder.image, placeholder.memory.memory,
                                   placeholder.memory.offset};
  result = device.vk.vkBindImageMemory2(device.device, 1, &bind);
  if (result != VK_SUCCESS) return call_error(result, "vkBindImageMemory2", "placeholder image");
  VkImageViewCreateInfo view{};
  view.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO;
  view.image = placeholder.image;
  view.viewType = VK_IMAGE_VIEW_TYPE_2D;
  view.format = placeholder.format;
  view.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
  result = device.vk.vkCreateImageView(device.device, &view, device.allocator, &placeholder.view);
  if (result != VK_SUCCESS) placeholder.view = VK_NULL_HANDLE;
  return call_error(result, "vkCreateImageView", "placeholder image");
}

Error create_buffer(const Device& device, Placeholder& placeholder) {
  const VkBufferCreateInfo info =
      buffer_create_info({placeholder_buffer_bytes,
                          VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT});
  VkResult result =
      device.vk.vkCreateBuffer(device.device, &info, device.allocator, &placeholder.buffer);
  if (result != VK_SUCCESS) {
    placeholder.buffer = VK_NULL_HANDLE;
    return call_error(result, "vkCreateBuffer", "placeholder of an unbound port");
  }
  VkMemoryRequirements needs{};
  device.vk.vkGetBufferMemoryRequirements(device.device, placeholder.buffer, &needs);
  if (Error error =
          allocate_memory(device, request_of(needs), "placeholder buffer", placeholder.memory))
    return error;
  const VkBindBufferMemoryInfo bind{VK_STRUCTURE_TYPE_BIND_BUFFER_MEMORY_INFO, nullptr,
                                    placeholder.buffer, placeholder.memory.memory,
                                    placeholder.memory.offset};
  result = device.vk.vkBindBufferMemory2(device.device, 1, &bind);
  return call_error(result, "vkBindBufferMemory2", "placeholder buffer");
}

} // namespace

uint32_t placeholder_for(State& state, const KernelPort& port, bool writes) {
  const bool buffer = *port.type == VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
  const VkFormat format = buffer ? VK_FORMAT_UNDEFINED : port.placeholder;
  // Read-only and writable placeholders are separate, so that reads need no barriers.
  const bool storage = buffer ? writes : *port.type == VK_DESCRIPTOR_TYPE_STORAGE_IMAGE;
  for (uint32_t i = 0; i < state.placeholders.size(); ++i)
    if (state.placeholders[i].format == format && state.placeholders[i].storage == storage)
      return i;
  Placeholder& added = state.placeholders.emplace_back();
  added.format = format;
  added.storage = storage;
  return static_cast<uint32_t>(state.placeholders.size() - 1);
}

Error create_placeholders(State& state) {
  for (Placeholder& placeholder : state.placeholders) {
    Error error = placeholder.format == VK_FORMAT_UNDEFINED
                      ? create_buffer(*state.device, placeholder)
                      : create_image(*state.device, placeholder);
    if (error) return error;
  }
  return {};
}

void destroy_placeholders(State& state) {
  const Device& device = *state.device;
  for (const Placeholder& placeholder : state.placeholders) {
    device.vk.vkDestroyImageView(device.device, placeholder.view, device.allocator);
    device.vk.vkDestroyImage(device.device, placeholder.image, device.allocator);
    device.vk.vkDestroyBuffer(device.device, placeholder.buffer, device.allocator);
    free_memory(device, placeholder.memory);
  }
}

} // namespace dermis::vulkan
