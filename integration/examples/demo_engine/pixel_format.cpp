#include "integration/examples/demo_engine/pixel_format.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

namespace demo {
namespace {

constexpr VkImageAspectFlags color = VK_IMAGE_ASPECT_COLOR_BIT;
constexpr VkImageAspectFlags depth = VK_IMAGE_ASPECT_DEPTH_BIT;

constexpr std::array pixel_formats = {
    PixelFormat{VK_FORMAT_R8_UINT, "r8_uint", 1, 1, color},
    PixelFormat{VK_FORMAT_R8_UNORM, "r8_unorm", 1, 1, color},
    PixelFormat{VK_FORMAT_R8G8_UNORM, "rg8_unorm", 2, 2, color},
    PixelFormat{VK_FORMAT_R8G8B8A8_UNORM, "rgba8_unorm", 4, 4, color},
    PixelFormat{VK_FORMAT_R8G8B8A8_SRGB, "rgba8_srgb", 4, 4, color},
    PixelFormat{VK_FORMAT_R16_UINT, "r16_uint", 1, 2, color},
    PixelFormat{VK_FORMAT_R32_UINT, "r32_uint", 1, 4, color},
    PixelFormat{VK_FORMAT_R16_SFLOAT, "r16f", 1, 2, color},
    PixelFormat{VK_FORMAT_R16G16_SFLOAT, "rg16f", 2, 4, color},
    PixelFormat{VK_FORMAT_R16G16B16A16_SFLOAT, "rgba16f", 4, 8, color},
    PixelFormat{VK_FORMAT_R32_SFLOAT, "r32f", 1, 4, color},
    PixelFormat{VK_FORMAT_R32G32_SFLOAT, "rg32f", 2, 8, color},
    PixelFormat{VK_FORMAT_R32G32B32A32_SFLOAT, "rgba32f", 4, 16, color},
    PixelFormat{VK_FORMAT_B10G11R11_UFLOAT_PACK32, "b10g11r11f", 3, 4, color},
    PixelFormat{VK_FORMAT_D16_UNORM, "d16", 1, 2, depth},
    PixelFormat{VK_FORMAT_D32_SFLOAT, "d32f", 1, 4, depth},
};

enum class Scalar { uint, unorm, srgb, half, single };

Scalar scalar_of(VkFormat format) {
  switch (format) {
  case VK_FORMAT_R8_UINT:
  case VK_FORMAT_R16_UINT:
  case VK_FORMAT_R32_UINT:
    return Scalar::uint;
  case VK_FORMAT_R8G8B8A8_SRGB:
    return Scalar::srgb;
  case VK_FORMAT_R16_SFLOAT:
  case VK_FORMAT_R16G16_SFLOAT:
  case VK_FORMAT_R16G16B16A16_SFLOAT:
    return Scalar::half;
  case VK_FORMAT_R32_SFLOAT:
  case VK_FORMAT_R32G32_SFLOAT:
  case VK_FORMAT_R32G32B32A32_SFLOAT:
  case VK_FORMAT_D32_SFLOAT:
    return Scalar::single;
  default:
    return Scalar::unorm;
  }
}

// Returns an unsigned small float with 5 exponent bits (bias 15) and `mantissa` bits: a shortened
// binary16 without sign.
uint32_t small_float_from_float(float value, int mantissa) {
  if (!(value > 0.0f)) return 0;
  const int shift = 10 - mantissa;
  const uint32_t largest = (30u << mantissa) | ((1u << mantissa) - 1u); // largest finite value
  const uint32_t half = half_from_float(std::min(value, 65504.0f));
  return std::min(largest, (half + (1u << (shift - 1))) >> shift);
}

void store_uint(std::byte* out, uint32_t bytes, uint32_t value) {
  std::memcpy(out, &value, bytes); // little endian, as Vulkan on all supported platforms
}

uint32_t load_uint(const std::byte* in, uint32_t bytes) {
  uint32_t value = 0;
  std::memcpy(&value, in, bytes);
  return value;
}

uint32_t unorm(float value, uint32_t largest) {
  if (!(value > 0.0f)) return 0;
  return static_cast<uint32_t>(std::lround(std::min(value, 1.0f) * static_cast<float>(largest)));
}

} // namespace

const PixelFormat* find_pixel_format(VkFormat format) {
  const auto found = std::find_if(pixel_formats.begin(), pixel_formats.end(),
                                  [&](const PixelFormat& one) { return one.format == format; });
  return found == pixel_formats.end() ? nullptr : &*found;
}

uint16_t half_from_float(float value) {
  const uint32_t bits = std::bit_cast<uint32_t>(value);
  const uint32_t sign = (bits >> 16) & 0x8000u;
  const uint32_t magnitude = bits & 0x7fffffffu;
  if (magnitude > 0x7f800000u) return static_cast<uint16_t>(sign | 0x7e00u);
  if (magnitude >= 0x47800000u) return static_cast<uint16_t>(sign | 0x7c00u); // >= 65536
  if (magnitude < 0x38800000u) {                                              // subnormal halves
    // Adding 0.5 aligns the last bit of the sum with 2^-24, the unit of subnormals; the addition
    // rounds.
    const float aligned = std::bit_cast<float>(magnitude) + 0.5f;
    return static_cast<uint16_t>(sign | (std::bit_cast<uint32_t>(aligned) - 0x3f000000u));
  }
  const uint32_t odd = (magnitude >> 13) & 1u;
  const uint32_t rounded = magnitude - 0x38000000u + 0xfffu + odd;
  // a carry into the exponent is correct, up to infinity
  return static_cast<uint16_t>(sign | (rounded >> 13));
}

float float_from_half(uint16_t bits) {
  const uint32_t sign = static_cast<uint32_t>(bits & 0x8000u) << 16;
  const uint32_t exponent = (bits >> 10) & 0x1fu, mantissa = bits & 0x3ffu;
  if (exponent == 31u) return std::bit_cast<float>(sign | 0x7f800000u | (mantissa << 13));
  if (exponent == 0u) {
    const float value = static_cast<float>(mantissa) * 0x1p-24f;
    return sign ? -value : value;
  }
  return std::bit_cast<float>(sign | ((exponent + 112u) << 23) | (mantissa << 13));
}

float srgb_from_linear(float linear) {
  return linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1.0f / 2.4f) - 0.055f;
}

float linear_from_srgb(float encoded) {
  return encoded <= 0.04045f ? encoded / 12.92f : std::pow((encoded + 0.055f) / 1.055f, 2.4f);
}

std::vector<std::byte> encode_texels(const PixelFormat& format, std::span<const float> texels,
                                     uint32_t channels) {
  const size_t count = channels == 0 ? 0 : texels.size() / channels;
  std::vector<std::byte> bytes(count * format.bytes);
  const Scalar scalar = scalar_of(format.format);
  const uint32_t size = format.bytes / format.channels;
  for (size_t i = 0; i < count; ++i) {
    std::array<float, 4> value = {0.0f, 0.0f, 0.0f, 1.0f};
    for (uint32_t c = 0; c < std::min(channels, 4u); ++c)
      value[c] = texels[i * channels + c];
    std::byte* out = bytes.data() + i * format.bytes;
    if (format.format == VK_FORMAT_B10G11R11_UFLOAT_PACK32) {
      store_uint(out, 4,
                 small_float_from_float(value[0], 6) | (small_float_from_float(value[1], 6) << 11) |
                     (small_float_from_float(value[2], 5) << 22));
      continue;
    }
    for (uint32_t c = 0; c < format.channels; ++c, out += size) {
      const auto largest = static_cast<uint32_t>((uint64_t{1} << (8 * size)) - 1);
      switch (scalar) {
      case Scalar::single:
        std::memcpy(out, &value[c], 4);
        break;
      case Scalar::half:
        store_uint(out, 2, half_from_float(value[c]));
        break;
      case Scalar::unorm:
        store_uint(out, size, unorm(value[c], largest));
        break;
      case Scalar::srgb:
        store_uint(out, 1,
                   unorm(c == 3 ? value[c] : srgb_from_linear(std::max(0.0f, value[c])), 255));
        break;
      case Scalar::uint:
        store_uint(out, size,
                   value[c] > 0.0f
                       ? static_cast<uint32_t>(std::min(std::nearbyint(double{value[c]}),
                                                        static_cast<double>(largest)))
                       : 0u);
        break;
      }
    }
  }
  return bytes;
}

std::vector<float> decode_texels(const PixelFormat& format, std::span<const std::byte> bytes) {
  const size_t count = bytes.size() / format.bytes;
  std::vector<float> texels(count * format.channels);
  const Scalar scalar = scalar_of(format.format);
  const uint32_t size = format.bytes / format.channels;
  float* out = texels.data();
  for (size_t i = 0; i < count; ++i) {
    const std::byte* in = bytes.data() + i * format.bytes;
    if (format.format == VK_FORMAT_B10G11R11_UFLOAT_PACK32) {
      const uint32_t packed = load_uint(in, 4);
      *out++ = float_from_half(static_cast<uint16_t>((packed & 0x7ffu) << 4));
      *out++ = float_from_half(static_cast<uint16_t>(((packed >> 11) & 0x7ffu) << 4));
      *out++ = float_from_half(static_cast<uint16_t>(((packed >> 22) & 0x3ffu) << 5));
      continue;
    }
    for (uint32_t c = 0; c < format.channels; ++c, in += size) {
      const auto largest = static_cast<float>((uint64_t{1} << (8 * size)) - 1);
      const uint32_t raw = load_uint(in, size);
      switch (scalar) {
      case Scalar::single:
        *out++ = std::bit_cast<float>(raw);
        break;
      case Scalar::half:
        *out++ = float_from_half(static_cast<uint16_t>(raw));
        break;
      case Scalar::unorm:
        *out++ = static_cast<float>(raw) / largest;
        break;
      case Scalar::srgb: {
        const float encoded = static_cast<float>(raw) / largest;
        *out++ = c == 3 ? encoded : linear_from_srgb(encoded);
        break;
      }
      case Scalar::uint:
        *out++ = static_cast<float>(raw);
        break;
      }
    }
  }
  return texels;
}

} // namespace demo
