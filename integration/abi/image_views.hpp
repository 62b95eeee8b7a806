#pragma once
// Creates image views for images that the host binds without one. A view is created once per
// content_id and kept while that id recurs.

#include "framegraph/vulkan/device.hpp"

#include <cstdint>
#include <vector>

namespace dermis::abi {

inline constexpr size_t image_views_a_slot = 8; // images that a host may alternate between

struct ImageViewKey {
  uint32_t slot = 0;
  VkImage image = VK_NULL_HANDLE;
  uint64_t content_id = 0; // unlike the image handle, never reused for another image
  VkFormat format = VK_FORMAT_UNDEFINED;
  VkImageAspectFlags aspect = 0;
  uint32_t layer = 0;
  bool operator==(const ImageViewKey&) const = default;
};

struct ImageViews {
  explicit ImageViews(const vulkan::Device& owner) : device(owner) {}
  ~ImageViews(); // requires that the device has finished all frames
  ImageViews(const ImageViews&) = delete;
  ImageViews& operator=(const ImageViews&) = delete;

  struct Entry {
    ImageViewKey key;
    VkImageView view = VK_NULL_HANDLE;
    uint64_t last_frame = 0;   // last frame that used the view, if it was recorded
    uint64_t frame_before = 0; // last frame that used the view before that
    uint64_t id = 0;           // of the view; unlike the handle, never reused
  };
  const vulkan::Device& device;
  std::vector<Entry> entries; // entries of one slot are adjacent
  uint64_t last_id = 0;
};

// Allocates entries for `slots` slots. May throw std::bad_alloc; then nothing has changed.
void reserve(ImageViews& views, size_t slots);

struct KnownView {
  VkImageView view = VK_NULL_HANDLE;
  uint64_t id = 0;
};

// Returns the view for `key`, for use by frame `frame_index`. Replaces views that no frame after
// `completed` uses; frames after `recorded` were discarded or rejected, and use none. Errors: those
// of vkCreateImageView; VK_ERROR_TOO_MANY_OBJECTS if more images alternate than there are entries.
// Allocates no host memory of the library.
VkResult find_image_view(ImageViews& views, const ImageViewKey& key, uint64_t frame_index,
                         uint64_t recorded, uint64_t completed, KnownView& view) noexcept;

} // namespace dermis::abi
