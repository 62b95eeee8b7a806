#pragma once
// How images and buffers of a plan are created: the same infos for asking the driver what memory they need
// and for creating them.

#include "framegraph/compile/device_profile.hpp"

#include <vulkan/vulkan_core.h>

namespace dermis::vulkan {

// Optimal tiling, one sample, exclusive, 2-D. Free-threaded.
VkImageCreateInfo image_create_info(const ImageDescription& image);
// Exclusive. Free-threaded.
VkBufferCreateInfo buffer_create_info(const BufferDescription& buffer);
// The aspects a barrier must name: depth, with stencil where the format has it, or colour. Free-threaded.
VkImageAspectFlags barrier_aspects(Format format);
VkFormat vk_format(Format format);

} // namespace dermis::vulkan
