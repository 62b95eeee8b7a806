#pragma once
// Image views of images that the host binds without one: made once for each content_id, kept while it comes
// back.

#include "framegraph/vulkan/device.hpp"

#include <cstdint>
#include <vector>

namespace dermis::abi {

inline constexpr size_t image_views_a_slot = 8; // images that a host may take turns with

struct ImageViewKey {
  uint32_t slot = 0;
  VkImage image = VK_NULL_HANDLE;
  uint64_t content_id = 0; // an image handle may be another image later on, this may not
  VkFormat format = VK_FORMAT_UNDEFINED;
  VkImageAspectFlags aspect = 0;
  uint32_t layer = 0;
  bool operator==(const ImageViewKey&) const = default;
};

struct ImageViews {
  explicit ImageViews(const vulkan::Device& owner) : device(owner) {}
  ~ImageViews(); // the device has finished all frames
  ImageViews(const ImageViews&) = delete;
  ImageViews& operator=(const ImageViews&) = delete;

  struct Entry {
    ImageViewKey key;
    VkImageView view = VK_NULL_HANDLE;
    uint64_t last_frame = 0; // that used it
  };
  const vulkan::Device& device;
  std::vector<Entry> entries; // those of a slot lie together
};

// Room for so many slots. May throw std::bad_alloc; then nothing changed.
void reserve(ImageViews& views, size_t slots);

// The view for `key`, used by frame `frame_index`. Views that no frame after `completed` uses make room.
// Errors: of vkCreateImageView; VK_ERROR_TOO_MANY_OBJECTS when more images take turns than there is room for.
// Allocates no host memory of the library.
VkResult find_image_view(ImageViews& views, const ImageViewKey& key, uint64_t frame_index, uint64_t completed,
                         VkImageView& view) noexcept;

} // namespace dermis::abi
