#pragma once
// The properties of a device that compilation needs, as a value. `generic_profile()` is for tools
// and tests without a device; framegraph/vulkan/ fills a profile from a real device.

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
  // maxImageArrayLayers and maxStorageBufferRange; the defaults are the minima that Vulkan
  // guarantees.
  uint32_t max_image_layers = 256;
  uint64_t max_storage_buffer_bytes = 1ull << 27;
  // Memory types that are device-local: each heap keeps one of them if its occupants allow that.
  uint32_t device_local_type_bits = 0xffffffffu;
  uint32_t max_workgroup_count = 65535; // minimum of the three dimensions
  uint32_t max_push_constants_bytes = 128;
  Features features = 0; // supported and enabled
  // Returns whether the device supports the format with these VkImageUsageFlags.
  std::function<bool(Format, uint32_t vk_usage)> supports;
  std::function<bool(Format)> filters; // whether the device filters it linearly
  std::function<MemoryNeeds(const ImageDescription&)> image_needs;
  std::function<MemoryNeeds(const BufferDescription&)> buffer_needs;
};

// Returns a profile with memory needs rounded up to 64 KiB, one memory type, the formats that
// common devices support, and every feature, so that all of a graph is checked.
DeviceProfile generic_profile();

} // namespace dermis
