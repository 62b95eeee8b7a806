#pragma once
// PNG pictures in sRGB, and the curve between them and linear light. Read: 8 or 16 bits a channel;
// written: 8.

#include "integration/tools/files/image.hpp"

#include <array>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace dermis::tools {

// IEC 61966-2-1. Linear in [0, 1] to encoded in [0, 1] and back; values outside are clamped, NaN becomes 0.
float srgb_encode(float linear);
float srgb_decode(float encoded);

// 8-bit sRGB of a linear picture with 3 channels, rounded to nearest.
std::vector<uint8_t> encode_srgb8(const Image& linear);

// width * height * 3 bytes as a PNG file; empty if a size does not fit.
std::vector<uint8_t> encode_png(uint32_t width, uint32_t height, std::span<const uint8_t> rgb);

// Writes width * height * 3 bytes as PNG. Atomic; see bytes.hpp for failures.
bool write_png(const std::filesystem::path& path, uint32_t width, uint32_t height,
               std::span<const uint8_t> rgb, std::string& error);

// Reads a PNG with all its bits as 3 linear channels (sRGB decoded, transparency dropped). Empty on failure,
// with the reason.
std::optional<Image> read_png(const std::filesystem::path& path, std::string& error);

} // namespace dermis::tools
