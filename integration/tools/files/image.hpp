#pragma once
// An image in memory, used by files and metrics.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace dermis::tools {

// Values are interleaved and row-major, with the top row first: values[(y * width + x) * channels +
// channel].
struct Image {
  uint32_t width = 0, height = 0, channels = 0;
  std::vector<float> values;

  static Image sized(uint32_t width, uint32_t height, uint32_t channels) {
    return {width, height, channels, std::vector<float>(size_t{width} * height * channels)};
  }
  float& at(uint32_t x, uint32_t y, uint32_t channel) {
    return values[(size_t{y} * width + x) * channels + channel];
  }
  float at(uint32_t x, uint32_t y, uint32_t channel) const {
    return values[(size_t{y} * width + x) * channels + channel];
  }
};

// Maximum side of an image file. Vulkan guarantees image sides of 4096; current devices stop at
// 32768.
inline constexpr uint32_t max_image_side = 32768;
inline constexpr uint64_t max_image_bytes = uint64_t{4} << 30; // decoded
inline constexpr uint64_t max_image_file_bytes = uint64_t{1} << 30;

// Returns how many decoded bytes are read from a file. Above 1 GiB the file must have at least
// 1/1032 of them: deflate packs at most 258 bytes into 2 bits.
constexpr uint64_t max_decoded_bytes(uint64_t file_bytes) {
  constexpr uint64_t always_read = uint64_t{1} << 30, max_packing = 258 * 8 / 2;
  return std::min(max_image_bytes, std::max(always_read, max_packing * file_bytes));
}

} // namespace dermis::tools
