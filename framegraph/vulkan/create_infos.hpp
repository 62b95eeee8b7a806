#pragma once
// Builds the create infos of a plan's images and buffers. The infos that create a resource also
// query its memory requirements.

#include "framegraph/compile/device_profile.hpp"

#include <vulkan/vulkan_core.h>

namespace dermis::vulkan {

// An image needs one of these usages to have a view that passes can use; images that are only
// cleared or copied have none.
inline constexpr uint32_t viewable_usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_STORAGE_BIT;

// Returns info for a 2-D image with optimal tiling, one sample and exclusive sharing.
// Free-threaded.
VkImageCreateInfo image_create_info(const ImageDescription& image);
// Returns info for a buffer with exclusive sharing. Free-threaded.
VkBufferCreateInfo buffer_create_info(const BufferDescription& buffer);
// Returns the aspects that a barrier must name: colour, depth, or depth and stencil if the format
// has both. Free-threaded.
VkImageAspectFlags barrier_aspects(Format format);
VkFormat vk_format(Format format);

} // namespace dermis::vulkan
