#pragma once
// Pixel formats that the engine converts between floats and images. fp16 is rounded to nearest
// even, unorm and sRGB are clamped to [0, 1] and rounded to nearest, integers are clamped to their
// range.

#include "integration/examples/demo_engine/result.hpp"

#include <volk.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace demo {

struct PixelFormat {
  VkFormat format;
  std::string_view name; // name in graph files: "rgba16f"
  uint32_t channels;     // floats per texel
  uint32_t bytes;        // bytes per texel
  VkImageAspectFlags aspect;
};

// Returns nullptr for formats that the engine cannot convert.
const PixelFormat* find_pixel_format(VkFormat format);

// Returns the binary16 bits of a float: nearest even, overflow to infinity, NaN stays NaN.
uint16_t half_from_float(float value);
float float_from_half(uint16_t bits);

// Convert linear [0, 1] to the sRGB curve and back (IEC 61966-2-1).
float srgb_from_linear(float linear);
float linear_from_srgb(float encoded);

// Converts floats to texels. `texels` holds `channels` floats per texel (missing channels: 0, alpha
// 1). Thread: any. Errors: none.
std::vector<std::byte> encode_texels(const PixelFormat& format, std::span<const float> texels,
                                     uint32_t channels);
// Returns format.channels floats per texel. bytes.size() must be a multiple of format.bytes.
// Thread: any. Errors: none.
std::vector<float> decode_texels(const PixelFormat& format, std::span<const std::byte> bytes);

} // namespace demo
