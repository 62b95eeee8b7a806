#pragma once
// Which pixel formats the engine moves between floats and images, and how: fp16 is rounded to nearest even,
// unorm and sRGB are clamped to [0, 1] and rounded to nearest, integers are clamped to their range.

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
  std::string_view name; // as in graph files: "rgba16f"
  uint32_t channels;     // of the floats that stand for a texel
  uint32_t bytes;        // of a texel
  VkImageAspectFlags aspect;
};

// nullptr for formats the engine cannot convert.
const PixelFormat* find_pixel_format(VkFormat format);

// binary16 bits of a float: nearest even, overflow to infinity, NaN stays NaN.
uint16_t half_from_float(float value);
float float_from_half(uint16_t bits);

// Linear [0, 1] to the sRGB curve and back (IEC 61966-2-1).
float srgb_from_linear(float linear);
float linear_from_srgb(float encoded);

// `texels` holds channels floats a texel (missing channels: 0, alpha 1). Any thread. Errors: none.
std::vector<std::byte> encode_texels(const PixelFormat& format, std::span<const float> texels,
                                     uint32_t channels);
// format.channels floats a texel. bytes.size() must be a multiple of format.bytes. Any thread. Errors: none.
std::vector<float> decode_texels(const PixelFormat& format, std::span<const std::byte> bytes);

} // namespace demo
