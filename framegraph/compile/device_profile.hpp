#pragma once
// What compiling must know of a device, as a value. `generic_profile()` serves everything that runs without a
// device; framegraph/vulkan/ fills one from a real device.

#include "framegraph/model/vocabulary.hpp"

#include <cstdint>
#include <functional>
#include <string>

namespace dermis {

struct ImageDescription {
  Format format = Format::undefined;
  uint32_t width = 1, height = 1, mips = 1, layers = 1;
  uint32_t vk_usage = 0;
};

struct BufferDescription {
  uint64_t bytes = 0;
  uint32_t vk_usage = 0;
};

struct MemoryNeeds {
  uint64_t size = 0, alignment = 1;
  uint32_t memory_type_bits = 0;
};

struct DeviceProfile {
  std::string name = "generic";
  uint64_t buffer_image_granularity = 1;
  uint32_t max_image_dimension = 16384;
  uint32_t max_image_layers = 256; // maxImageArrayLayers; the default is the least Vulkan allows
  uint64_t max_storage_buffer_bytes = 1ull
                                      << 27; // maxStorageBufferRange; the default is the least Vulkan allows
  uint32_t device_local_type_bits =
      0xffffffffu;                      // memory types a heap must keep one of where its occupants can
  uint32_t max_workgroup_count = 65535; // smallest of the three dimensions
  uint32_t max_push_constants_bytes = 128;
  Features features = 0; // that it has, enabled
  // May the format be used so? vk_usage are VkImageUsageFlags.
  std::function<bool(Format, uint32_t vk_usage)> supports;
  std::function<MemoryNeeds(const ImageDescription&)> image_needs;
  std::function<MemoryNeeds(const BufferDescription&)> buffer_needs;
};

// Texels times packed size and bytes, rounded to 64 KiB; one memory type; what common devices support; every
// feature, so that all of a graph is checked.
DeviceProfile generic_profile();

} // namespace dermis
