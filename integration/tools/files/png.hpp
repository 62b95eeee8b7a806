#pragma once
// Reads and writes sRGB PNG images. Reading accepts 8 or 16 bits per channel; writing uses 8.

#include "integration/tools/files/image.hpp"

#include <array>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace dermis::tools {

// The sRGB curve (IEC 61966-2-1) between linear and encoded values in [0, 1]. Values outside are
// clamped; NaN becomes 0.
float srgb_encode(float linear);
float srgb_decode(float encoded);

// Encodes width * height * 3 bytes as a PNG file. Returns an empty vector if the sizes do not fit.
std::vector<uint8_t> encode_png(uint32_t width, uint32_t height, std::span<const uint8_t> rgb);

// Writes width * height * 3 bytes as PNG. Atomic; bytes.hpp describes failures.
bool write_png(const std::filesystem::path& path, uint32_t width, uint32_t height,
               std::span<const uint8_t> rgb, std::string& error);

// Reads a PNG at full bit depth as 3 linear channels (sRGB decoded, alpha dropped). On failure
// returns nullopt and sets `error`.
std::optional<Image> read_png(const std::filesystem::path& path, std::string& error);

} // namespace dermis::tools
