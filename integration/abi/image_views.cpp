#include "integration/abi/image_views.hpp"

#include <algorithm>
#include <span>

namespace dermis::abi {
namespace {

VkResult create(const vulkan::Device& device, const ImageViewKey& key, VkImageView& view) {
  VkImageViewCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO;
  info.image = key.image;
  info.viewType = VK_IMAGE_VIEW_TYPE_2D;
  info.format = key.format;
  info.subresourceRange = {key.aspect, 0, 1, key.layer, 1};
  return device.vk.vkCreateImageView(device.device, &info, device.allocator, &view);
}

// Returns the last recorded frame that used the view; 0: none.
uint64_t last_use(const ImageViews::Entry& entry, uint64_t recorded) {
  return entry.last_frame > recorded ? entry.frame_before : entry.last_frame;
}

} // namespace

ImageViews::~ImageViews() {
  for (const Entry& entry : entries)
    device.vk.vkDestroyImageView(device.device, entry.view, device.allocator);
}

void reserve(ImageViews& views, size_t slots) {
  if (views.entries.size() < slots * image_views_a_slot)
    views.entries.resize(slots * image_views_a_slot);
}

VkResult find_image_view(ImageViews& views, const ImageViewKey& key, uint64_t frame_index,
                         uint64_t recorded, uint64_t completed, KnownView& view) noexcept {
  const auto slot =
      std::span(views.entries).subspan(key.slot * image_views_a_slot, image_views_a_slot);
  const auto known = std::find_if(slot.begin(), slot.end(), [&](const ImageViews::Entry& entry) {
    return entry.view != VK_NULL_HANDLE && entry.key == key;
  });
  if (known != slot.end()) {
    known->frame_before = last_use(*known, recorded);
    known->last_frame = frame_index;
    view = {known->view, known->id};
    return VK_SUCCESS;
  }
  // Selects the least recently used entry; unused entries come first.
  const auto oldest = std::min_element(slot.begin(), slot.end(),
                                       [&](const ImageViews::Entry& a, const ImageViews::Entry& b) {
                                         return last_use(a, recorded) < last_use(b, recorded);
                                       });
  if (oldest->view != VK_NULL_HANDLE && last_use(*oldest, recorded) > completed)
    return VK_ERROR_TOO_MANY_OBJECTS;
  VkImageView made = VK_NULL_HANDLE;
  if (const VkResult result = create(views.device, key, made); result != VK_SUCCESS) return result;
  views.device.vk.vkDestroyImageView(views.device.device, oldest->view, views.device.allocator);
  *oldest = {key, made, frame_index, 0, ++views.last_id};
  view = {made, oldest->id};
  return VK_SUCCESS;
}

} // namespace dermis::abi
