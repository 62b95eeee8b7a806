#pragma once
// Images and buffers that own their memory, and transfers of floats to and from images.

#include "integration/examples/demo_engine/pixel_format.hpp"
#include "integration/examples/demo_engine/vulkan_host.hpp"

#include <span>
#include <vector>

namespace demo {

// Owns buffer and memory. `mapped` is null for device memory. Move-only; must be destroyed before
// its host.
struct Buffer {
  const VulkanHost* host = nullptr;
  VkBuffer buffer = VK_NULL_HANDLE;
  VkDeviceMemory memory = VK_NULL_HANDLE;
  uint64_t size = 0; // bytes
  void* mapped = nullptr;

  Buffer() = default;
  Buffer(Buffer&& other) noexcept;
  Buffer& operator=(Buffer&& other) noexcept;
  ~Buffer();
};

// Owns image, views and memory. Move-only; must be destroyed before its host.
struct Image {
  const VulkanHost* host = nullptr;
  VkImage image = VK_NULL_HANDLE;
  VkDeviceMemory memory = VK_NULL_HANDLE;
  VkImageView view = VK_NULL_HANDLE;    // all mips and layers (an array view when layers > 1)
  std::vector<VkImageView> layer_views; // by layer, mip 0; empty if layers == 1
  VkFormat format = VK_FORMAT_UNDEFINED;
  VkImageAspectFlags aspect = 0;
  uint32_t width = 0, height = 0, mips = 1, layers = 1;
  uint64_t id = 0; // never reused on the host, unlike the handles

  Image() = default;
  Image(Image&& other) noexcept;
  Image& operator=(Image&& other) noexcept;
  ~Image();
};

// Description of an image. create_image adds no usage; callers must request `transfer_*` usages.
struct ImageDesc {
  VkFormat format = VK_FORMAT_UNDEFINED;
  uint32_t width = 1, height = 1; // pixels, 1..16384
  uint32_t mips = 1, layers = 1;
  VkImageUsageFlags usage = 0;
};

// State of an image: its layout and the last access, with the names of dermis.h.
struct ImageState {
  VkImageLayout layout = VK_IMAGE_LAYOUT_UNDEFINED;
  VkPipelineStageFlags2 stages = VK_PIPELINE_STAGE_2_NONE;
  VkAccessFlags2 access = VK_ACCESS_2_NONE;
};

// Creates a buffer, host-visible and mapped if `host_visible`, else in device memory. Errors:
// environment.
Result<Buffer> create_buffer(VulkanHost& host, uint64_t size, VkBufferUsageFlags usage,
                             bool host_visible);
// Errors: usage (a size outside the device's limits), environment.
Result<Image> create_image(VulkanHost& host, const ImageDesc& desc);

// Records a barrier from one state to another for all mips and layers.
void transition(const VulkanHost& host, VkCommandBuffer commands, const Image& image,
                const ImageState& from, const ImageState& to);

// Records a barrier for all memory; layouts are ignored.
void memory_barrier(const VulkanHost& host, VkCommandBuffer commands, const ImageState& from,
                    const ImageState& to);

// Fills mip 0 with texels in the image's own format, row by row from the top, and computes other
// mips by halving. Leaves the image in `after`. The image needs TRANSFER_DST (and TRANSFER_SRC for
// mips > 1). Waits for the device. Errors: internal (the size does not fit), environment.
Result<> upload_texels(VulkanHost& host, Image& image, std::span<const std::byte> texels,
                       const ImageState& after);
// Uploads `channels` floats per texel, converted to the image's format; otherwise as upload_texels.
Result<> upload_image(VulkanHost& host, Image& image, std::span<const float> texels,
                      uint32_t channels, const ImageState& after);
// Reads mip 0 of `layer` as find_pixel_format(image.format)->channels floats per texel. The image
// must be in `state` and is left in it; needs TRANSFER_SRC. Waits for the device. Errors: internal,
// environment.
Result<std::vector<float>> read_image(VulkanHost& host, const Image& image, const ImageState& state,
                                      uint32_t layer = 0);
// Creates a buffer in device memory with these bytes. Waits for the device. Errors: environment.
Result<Buffer> upload_buffer(VulkanHost& host, std::span<const std::byte> bytes,
                             VkBufferUsageFlags usage);

} // namespace demo
