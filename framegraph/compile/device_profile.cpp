#include "framegraph/compile/device_profile.hpp"

#include <algorithm>

namespace dermis {
namespace {

constexpr uint64_t page = 64 * 1024; // placement alignment of images on common desktop devices
constexpr uint32_t storage_image_usage = 0x8;        // VK_IMAGE_USAGE_STORAGE_BIT
constexpr uint32_t transfer_destination_usage = 0x2; // VK_IMAGE_USAGE_TRANSFER_DST_BIT

MemoryNeeds whole_pages(uint64_t bytes) {
  return {std::max<uint64_t>((bytes + page - 1) / page, 1) * page, page, 1u};
}

MemoryNeeds needs_of_image(const ImageDescription& image) {
  uint64_t texels = 0;
  for (uint32_t level = 0; level < image.mips && level < 32; ++level)
    texels += uint64_t{std::max(image.width >> level, 1u)} * std::max(image.height >> level, 1u);
  return whole_pages(texels * image.layers * format_info(image.format).bytes_per_texel);
}

// Depth and sRGB formats can be sampled but not stored. Depth is cleared as an attachment, not by a
// transfer.
bool usable(Format format, uint32_t vk_usage) {
  if (format == Format::undefined || format >= Format::count) return false;
  const bool storable = !format_info(format).depth && format != Format::rgba8_srgb;
  if ((vk_usage & storage_image_usage) && !storable) return false;
  return !((vk_usage & transfer_destination_usage) && format_info(format).depth);
}

} // namespace

DeviceProfile generic_profile() {
  DeviceProfile profile;
  profile.features = (Features{1} << static_cast<uint32_t>(Feature::count)) - 1;
  profile.supports = usable;
  profile.filters = [](Format format) { return !has_unsigned_components(format); };
  profile.image_needs = needs_of_image;
  profile.buffer_needs = [](const BufferDescription& buffer) { return whole_pages(buffer.bytes); };
  return profile;
}

} // namespace dermis
