#include "framegraph/vulkan/device_profile.hpp"

#include "framegraph/vulkan/create_infos.hpp"

#include <algorithm>

namespace dermis::vulkan {
namespace {

MemoryNeeds needs_of(const VkMemoryRequirements2& requirements) {
  return {requirements.memoryRequirements.size, requirements.memoryRequirements.alignment,
          requirements.memoryRequirements.memoryTypeBits};
}

bool supports(const Device& device, Format format, uint32_t vk_usage) {
  if (format == Format::undefined) return false;
  VkPhysicalDeviceImageFormatInfo2 info{};
  info.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_IMAGE_FORMAT_INFO_2;
  info.format = vk_format(format);
  info.type = VK_IMAGE_TYPE_2D;
  info.tiling = VK_IMAGE_TILING_OPTIMAL;
  info.usage = vk_usage;
  VkImageFormatProperties2 properties{};
  properties.sType = VK_STRUCTURE_TYPE_IMAGE_FORMAT_PROPERTIES_2;
  return device.vk.vkGetPhysicalDeviceImageFormatProperties2(device.physical, &info, &properties) ==
         VK_SUCCESS;
}

bool filters(const Device& device, Format format) {
  VkFormatProperties2 properties{};
  properties.sType = VK_STRUCTURE_TYPE_FORMAT_PROPERTIES_2;
  device.vk.vkGetPhysicalDeviceFormatProperties2(device.physical, vk_format(format), &properties);
  return (properties.formatProperties.optimalTilingFeatures &
          VK_FORMAT_FEATURE_SAMPLED_IMAGE_FILTER_LINEAR_BIT) != 0;
}

MemoryNeeds image_needs(const Device& device, const ImageDescription& image) {
  const VkImageCreateInfo create = image_create_info(image);
  const VkDeviceImageMemoryRequirements query{VK_STRUCTURE_TYPE_DEVICE_IMAGE_MEMORY_REQUIREMENTS,
                                              nullptr, &create, VK_IMAGE_ASPECT_NONE};
  VkMemoryRequirements2 requirements{};
  requirements.sType = VK_STRUCTURE_TYPE_MEMORY_REQUIREMENTS_2;
  device.vk.vkGetDeviceImageMemoryRequirements(device.device, &query, &requirements);
  return needs_of(requirements);
}

MemoryNeeds buffer_needs(const Device& device, const BufferDescription& buffer) {
  const VkBufferCreateInfo create = buffer_create_info(buffer);
  const VkDeviceBufferMemoryRequirements query{VK_STRUCTURE_TYPE_DEVICE_BUFFER_MEMORY_REQUIREMENTS,
                                               nullptr, &create};
  VkMemoryRequirements2 requirements{};
  requirements.sType = VK_STRUCTURE_TYPE_MEMORY_REQUIREMENTS_2;
  device.vk.vkGetDeviceBufferMemoryRequirements(device.device, &query, &requirements);
  return needs_of(requirements);
}

uint32_t device_local_types(const Device& device) {
  uint32_t bits = 0;
  for (uint32_t i = 0; i < device.memory.memoryTypeCount; ++i)
    if (device.memory.memoryTypes[i].propertyFlags & VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT)
      bits |= 1u << i;
  return bits;
}

} // namespace

DeviceProfile device_profile(const Device& device) {
  const VkPhysicalDeviceLimits& limits = device.properties.limits;
  DeviceProfile profile;
  profile.name = device.properties.deviceName;
  profile.buffer_image_granularity = limits.bufferImageGranularity;
  profile.max_image_dimension = limits.maxImageDimension2D;
  profile.max_image_layers = limits.maxImageArrayLayers;
  profile.max_storage_buffer_bytes = limits.maxStorageBufferRange;
  profile.device_local_type_bits = device_local_types(device);
  profile.max_workgroup_count =
      std::min({limits.maxComputeWorkGroupCount[0], limits.maxComputeWorkGroupCount[1],
                limits.maxComputeWorkGroupCount[2]});
  profile.max_push_constants_bytes = limits.maxPushConstantsSize;
  profile.features = device.features;
  profile.supports = [&device](Format format, uint32_t vk_usage) {
    return supports(device, format, vk_usage);
  };
  profile.filters = [&device](Format format) { return filters(device, format); };
  profile.image_needs = [&device](const ImageDescription& image) {
    return image_needs(device, image);
  };
  profile.buffer_needs = [&device](const BufferDescription& buffer) {
    return buffer_needs(device, buffer);
  };
  return profile;
}

} // namespace dermis::vulkan
