#include "framegraph/vulkan/create_infos.hpp"

namespace dermis::vulkan {

VkImageCreateInfo image_create_info(const ImageDescription& image) {
  VkImageCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO;
  info.imageType = VK_IMAGE_TYPE_2D;
  info.format = vk_format(image.format);
  info.extent = {image.width, image.height, 1};
  info.mipLevels = image.mips;
  info.arrayLayers = image.layers;
  info.samples = VK_SAMPLE_COUNT_1_BIT;
  info.tiling = VK_IMAGE_TILING_OPTIMAL;
  info.usage = image.vk_usage;
  info.sharingMode = VK_SHARING_MODE_EXCLUSIVE;
  info.initialLayout = VK_IMAGE_LAYOUT_UNDEFINED;
  return info;
}

VkBufferCreateInfo buffer_create_info(const BufferDescription& buffer) {
  VkBufferCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO;
  info.size = buffer.bytes;
  info.usage = buffer.vk_usage;
  info.sharingMode = VK_SHARING_MODE_EXCLUSIVE;
  return info;
}

VkImageAspectFlags barrier_aspects(Format format) {
  if (format == Format::d24s8 || format == Format::d32fs8)
    return VK_IMAGE_ASPECT_DEPTH_BIT | VK_IMAGE_ASPECT_STENCIL_BIT;
  return format_info(format).depth ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT;
}

VkFormat vk_format(Format format) {
  return static_cast<VkFormat>(format_info(format).vulkan);
}

} // namespace dermis::vulkan
