#pragma once
// Builds the create infos of a plan's images and buffers. The infos that create a resource also
// query its memory requirements.

#include "framegraph/compile/device_profile.hpp"

#include <vulkan/vulkan_core.h>

namespace dermis::vulkan {

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
