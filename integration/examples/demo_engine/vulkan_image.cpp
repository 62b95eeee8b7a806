#include "integration/examples/demo_engine/vulkan_image.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <utility>

namespace demo {
namespace {

VkImageSubresourceRange whole(const Image& image) {
  return {image.aspect, 0, image.mips, 0, image.layers};
}

VkResult create_view(VulkanHost& host, const Image& image, VkImageViewType type,
                     VkImageSubresourceRange range, VkImageView& view) {
  auto info = vulkan_struct<VkImageViewCreateInfo>(VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO);
  info.image = image.image;
  info.viewType = type;
  info.format = image.format;
  info.subresourceRange = range;
  return host.vk.vkCreateImageView(host.device, &info, nullptr, &view);
}

// Records the computation of one mip from the next finer one. Both must be in TRANSFER_DST; the
// finer mip ends in TRANSFER_SRC.
void record_mip(const VulkanHost& host, VkCommandBuffer commands, const Image& image,
                uint32_t mip) {
  auto barrier = vulkan_struct<VkImageMemoryBarrier2>(VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2);
  barrier.srcStageMask = VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT;
  barrier.srcAccessMask = VK_ACCESS_2_TRANSFER_WRITE_BIT;
  barrier.dstStageMask = VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT;
  barrier.dstAccessMask = VK_ACCESS_2_TRANSFER_READ_BIT;
  barrier.oldLayout = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL;
  barrier.newLayout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
  barrier.image = image.image;
  barrier.subresourceRange = {image.aspect, mip - 1, 1, 0, image.layers};
  auto dependency = vulkan_struct<VkDependencyInfo>(VK_STRUCTURE_TYPE_DEPENDENCY_INFO);
  dependency.imageMemoryBarrierCount = 1;
  dependency.pImageMemoryBarriers = &barrier;
  host.vk.vkCmdPipelineBarrier2(commands, &dependency);
  const auto extent = [&](uint32_t size, uint32_t level) {
    return static_cast<int32_t>(std::max(1u, size >> level));
  };
  VkImageBlit blit{};
  blit.srcSubresource = {image.aspect, mip - 1, 0, image.layers};
  blit.srcOffsets[1] = {extent(image.width, mip - 1), extent(image.height, mip - 1), 1};
  blit.dstSubresource = {image.aspect, mip, 0, image.layers};
  blit.dstOffsets[1] = {extent(image.width, mip), extent(image.height, mip), 1};
  host.vk.vkCmdBlitImage(commands, image.image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, image.image,
                         VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &blit, VK_FILTER_LINEAR);
}

template <typename Barrier>
void set_scopes(Barrier& barrier, const ImageState& from, const ImageState& to) {
  barrier.srcStageMask = from.stages;
  barrier.srcAccessMask = from.access;
  barrier.dstStageMask = to.stages;
  barrier.dstAccessMask = to.access;
}

} // namespace

Buffer::Buffer(Buffer&& other) noexcept {
  *this = std::move(other);
}

Buffer& Buffer::operator=(Buffer&& other) noexcept {
  std::swap(host, other.host);
  std::swap(buffer, other.buffer);
  std::swap(memory, other.memory);
  std::swap(size, other.size);
  std::swap(mapped, other.mapped);
  return *this;
}

Buffer::~Buffer() {
  if (!host) return;
  host->vk.vkDestroyBuffer(host->device, buffer, nullptr);
  host->vk.vkFreeMemory(host->device, memory, nullptr);
}

Image::Image(Image&& other) noexcept {
  *this = std::move(other);
}

Image& Image::operator=(Image&& other) noexcept {
  std::swap(host, other.host);
  std::swap(image, other.image);
  std::swap(memory, other.memory);
  std::swap(view, other.view);
  std::swap(layer_views, other.layer_views);
  std::swap(format, other.format);
  std::swap(aspect, other.aspect);
  std::swap(width, other.width);
  std::swap(height, other.height);
  std::swap(mips, other.mips);
  std::swap(layers, other.layers);
  std::swap(id, other.id);
  return *this;
}

Image::~Image() {
  if (!host) return;
  for (VkImageView one : layer_views)
    host->vk.vkDestroyImageView(host->device, one, nullptr);
  host->vk.vkDestroyImageView(host->device, view, nullptr);
  host->vk.vkDestroyImage(host->device, image, nullptr);
  host->vk.vkFreeMemory(host->device, memory, nullptr);
}

Result<Buffer> create_buffer(VulkanHost& host, uint64_t size, VkBufferUsageFlags usage,
                             bool host_visible) {
  Buffer buffer;
  buffer.host = &host;
  buffer.size = size;
  auto info = vulkan_struct<VkBufferCreateInfo>(VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO);
  info.size = std::max<uint64_t>(size, 4);
  info.usage = usage;
  VkResult result = host.vk.vkCreateBuffer(host.device, &info, nullptr, &buffer.buffer);
  if (result != VK_SUCCESS) return vulkan_error("vkCreateBuffer", result);
  VkMemoryRequirements needs{};
  host.vk.vkGetBufferMemoryRequirements(host.device, buffer.buffer, &needs);
  const uint32_t type =
      host_visible
          ? find_memory_type(host, needs.memoryTypeBits, VK_MEMORY_PROPERTY_HOST_CACHED_BIT,
                             VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT |
                                 VK_MEMORY_PROPERTY_HOST_COHERENT_BIT)
          : find_memory_type(host, needs.memoryTypeBits, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, 0);
  auto allocate = vulkan_struct<VkMemoryAllocateInfo>(VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO);
  allocate.allocationSize = needs.size;
  allocate.memoryTypeIndex = type;
  auto flags =
      vulkan_struct<VkMemoryAllocateFlagsInfo>(VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_FLAGS_INFO);
  flags.flags = VK_MEMORY_ALLOCATE_DEVICE_ADDRESS_BIT;
  if ((usage & VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT) != 0) allocate.pNext = &flags;
  result = host.vk.vkAllocateMemory(host.device, &allocate, nullptr, &buffer.memory);
  if (result != VK_SUCCESS) return vulkan_error("vkAllocateMemory", result);
  result = host.vk.vkBindBufferMemory(host.device, buffer.buffer, buffer.memory, 0);
  if (result == VK_SUCCESS && host_visible)
    result = host.vk.vkMapMemory(host.device, buffer.memory, 0, VK_WHOLE_SIZE, 0, &buffer.mapped);
  if (result != VK_SUCCESS) return vulkan_error("binding or mapping a buffer", result);
  return buffer;
}

Result<Image> create_image(VulkanHost& host, const ImageDesc& desc) {
  const uint32_t largest = host.properties.limits.maxImageDimension2D;
  if (desc.width == 0 || desc.height == 0 || desc.width > largest || desc.height > largest) {
    return Error{ErrorKind::usage,
                 fmt::format("an image of {}x{} pixels was requested; the device allows 1x1 to "
                             "{}x{}",
                             desc.width, desc.height, largest, largest)};
  }
  const PixelFormat* known = find_pixel_format(desc.format);
  if (!known)
    return Error{ErrorKind::internal,
                 fmt::format("unknown format {}", static_cast<int>(desc.format))};
  Image image;
  image.id = ++host.last_image;
  image.host = &host;
  image.format = desc.format;
  image.aspect = known->aspect;
  image.width = desc.width;
  image.height = desc.height;
  image.mips = desc.mips;
  image.layers = desc.layers;
  auto info = vulkan_struct<VkImageCreateInfo>(VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO);
  info.imageType = VK_IMAGE_TYPE_2D;
  info.format = desc.format;
  info.extent = {desc.width, desc.height, 1};
  info.mipLevels = desc.mips;
  info.arrayLayers = desc.layers;
  info.samples = VK_SAMPLE_COUNT_1_BIT;
  info.tiling = VK_IMAGE_TILING_OPTIMAL;
  info.usage = desc.usage;
  VkResult result = host.vk.vkCreateImage(host.device, &info, nullptr, &image.image);
  if (result != VK_SUCCESS) return vulkan_error("vkCreateImage", result);
  VkMemoryRequirements needs{};
  host.vk.vkGetImageMemoryRequirements(host.device, image.image, &needs);
  auto allocate = vulkan_struct<VkMemoryAllocateInfo>(VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO);
  allocate.allocationSize = needs.size;
  allocate.memoryTypeIndex =
      find_memory_type(host, needs.memoryTypeBits, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, 0);
  result = host.vk.vkAllocateMemory(host.device, &allocate, nullptr, &image.memory);
  if (result != VK_SUCCESS) return vulkan_error("vkAllocateMemory", result);
  result = host.vk.vkBindImageMemory(host.device, image.image, image.memory, 0);
  if (result != VK_SUCCESS) return vulkan_error("vkBindImageMemory", result);

  constexpr VkImageUsageFlags viewed = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_STORAGE_BIT |
                                       VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT |
                                       VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT;
  if ((desc.usage & viewed) == 0) return image;
  result = create_view(host, image,
                       desc.layers > 1 ? VK_IMAGE_VIEW_TYPE_2D_ARRAY : VK_IMAGE_VIEW_TYPE_2D,
                       whole(image), image.view);
  for (uint32_t layer = 0; layer < desc.layers && desc.layers > 1 && result == VK_SUCCESS;
       ++layer) {
    VkImageView view = VK_NULL_HANDLE;
    result = create_view(host, image, VK_IMAGE_VIEW_TYPE_2D, {image.aspect, 0, 1, layer, 1}, view);
    if (result == VK_SUCCESS) image.layer_views.push_back(view);
  }
  if (result != VK_SUCCESS) return vulkan_error("vkCreateImageView", result);
  return image;
}

void transition(const VulkanHost& host, VkCommandBuffer commands, const Image& image,
                const ImageState& from, const ImageState& to) {
  auto barrier = vulkan_struct<VkImageMemoryBarrier2>(VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2);
  set_scopes(barrier, from, to);
  barrier.oldLayout = from.layout;
  barrier.newLayout = to.layout;
  barrier.srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.image = image.image;
  barrier.subresourceRange = whole(image);
  auto dependency = vulkan_struct<VkDependencyInfo>(VK_STRUCTURE_TYPE_DEPENDENCY_INFO);
  dependency.imageMemoryBarrierCount = 1;
  dependency.pImageMemoryBarriers = &barrier;
  host.vk.vkCmdPipelineBarrier2(commands, &dependency);
}

void memory_barrier(const VulkanHost& host, VkCommandBuffer commands, const ImageState& from,
                    const ImageState& to) {
  auto barrier = vulkan_struct<VkMemoryBarrier2>(VK_STRUCTURE_TYPE_MEMORY_BARRIER_2);
  set_scopes(barrier, from, to);
  auto dependency = vulkan_struct<VkDependencyInfo>(VK_STRUCTURE_TYPE_DEPENDENCY_INFO);
  dependency.memoryBarrierCount = 1;
  dependency.pMemoryBarriers = &barrier;
  host.vk.vkCmdPipelineBarrier2(commands, &dependency);
}

Result<> upload_image(VulkanHost& host, Image& image, std::span<const float> texels,
                      uint32_t channels, const ImageState& after) {
  const PixelFormat* format = find_pixel_format(image.format);
  if (!format || texels.size() != uint64_t{image.width} * image.height * channels)
    return Error{ErrorKind::internal, "the texels do not fit the image they are uploaded to"};
  return upload_texels(host, image, encode_texels(*format, texels, channels), after);
}

Result<> upload_texels(VulkanHost& host, Image& image, std::span<const std::byte> bytes,
                       const ImageState& after) {
  const PixelFormat* format = find_pixel_format(image.format);
  if (!format || bytes.size() != uint64_t{image.width} * image.height * format->bytes)
    return Error{ErrorKind::internal, "the texels do not fit the image they are uploaded to"};
  auto staging = create_buffer(host, bytes.size(), VK_BUFFER_USAGE_TRANSFER_SRC_BIT, true);
  if (!staging) return staging.error();
  std::memcpy(staging->mapped, bytes.data(), bytes.size());
  return run_commands(host, [&](VkCommandBuffer commands) {
    const ImageState target = {VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                               VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT,
                               VK_ACCESS_2_TRANSFER_WRITE_BIT};
    transition(host, commands, image, {}, target);
    VkBufferImageCopy region{};
    region.imageSubresource = {image.aspect, 0, 0, 1};
    region.imageExtent = {image.width, image.height, 1};
    host.vk.vkCmdCopyBufferToImage(commands, staging->buffer, image.image, target.layout, 1,
                                   &region);
    for (uint32_t mip = 1; mip < image.mips; ++mip)
      record_mip(host, commands, image, mip);
    if (image.mips > 1) { // all mips except the last are in TRANSFER_SRC now
      ImageState last = target;
      auto barrier = vulkan_struct<VkImageMemoryBarrier2>(VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2);
      barrier.srcStageMask = last.stages;
      barrier.srcAccessMask = last.access;
      barrier.dstStageMask = after.stages;
      barrier.dstAccessMask = after.access;
      barrier.oldLayout = last.layout;
      barrier.newLayout = after.layout;
      barrier.image = image.image;
      barrier.subresourceRange = {image.aspect, image.mips - 1, 1, 0, image.layers};
      VkImageMemoryBarrier2 upper = barrier;
      upper.oldLayout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
      upper.subresourceRange = {image.aspect, 0, image.mips - 1, 0, image.layers};
      const VkImageMemoryBarrier2 both[] = {barrier, upper};
      auto dependency = vulkan_struct<VkDependencyInfo>(VK_STRUCTURE_TYPE_DEPENDENCY_INFO);
      dependency.imageMemoryBarrierCount = 2;
      dependency.pImageMemoryBarriers = both;
      host.vk.vkCmdPipelineBarrier2(commands, &dependency);
    } else {
      transition(host, commands, image, target, after);
    }
    return success();
  });
}

Result<std::vector<float>> read_image(VulkanHost& host, const Image& image, const ImageState& state,
                                      uint32_t layer) {
  const PixelFormat* format = find_pixel_format(image.format);
  if (!format || layer >= image.layers)
    return Error{ErrorKind::internal, "this image cannot be read back"};
  const uint64_t size = uint64_t{image.width} * image.height * format->bytes;
  auto staging = create_buffer(host, size, VK_BUFFER_USAGE_TRANSFER_DST_BIT, true);
  if (!staging) return staging.error();
  auto done = run_commands(host, [&](VkCommandBuffer commands) {
    const ImageState source = {VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                               VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_READ_BIT};
    transition(host, commands, image, state, source);
    VkBufferImageCopy region{};
    region.imageSubresource = {image.aspect, 0, layer, 1};
    region.imageExtent = {image.width, image.height, 1};
    host.vk.vkCmdCopyImageToBuffer(commands, image.image, source.layout, staging->buffer, 1,
                                   &region);
    transition(host, commands, image, source, state);
    memory_barrier(host, commands,
                   {{}, VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT},
                   {{}, VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT});
    return success();
  });
  if (!done) return done.error();
  return decode_texels(*format, {static_cast<const std::byte*>(staging->mapped), size});
}

Result<Buffer> upload_buffer(VulkanHost& host, std::span<const std::byte> bytes,
                             VkBufferUsageFlags usage) {
  auto staging = create_buffer(host, bytes.size(), VK_BUFFER_USAGE_TRANSFER_SRC_BIT, true);
  if (!staging) return staging.error();
  std::memcpy(staging->mapped, bytes.data(), bytes.size());
  auto buffer = create_buffer(host, bytes.size(), usage | VK_BUFFER_USAGE_TRANSFER_DST_BIT, false);
  if (!buffer) return buffer.error();
  auto done = run_commands(host, [&](VkCommandBuffer commands) {
    const VkBufferCopy region = {0, 0, bytes.size()};
    host.vk.vkCmdCopyBuffer(commands, staging->buffer, buffer->buffer, 1, &region);
    memory_barrier(host, commands,
                   {{}, VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT},
                   {{}, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, VK_ACCESS_2_MEMORY_READ_BIT});
    return success();
  });
  if (!done) return done.error();
  return buffer;
}

} // namespace demo
