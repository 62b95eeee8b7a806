#pragma once
// What reader and writer of OpenEXR files agree on ("OpenEXR File Layout", Academy Software Foundation).

#include <cstdint>
#include <span>
#include <vector>

namespace dermis::tools::exr_layout {

inline constexpr uint32_t magic = 20000630;
inline constexpr uint32_t version = 2, version_mask = 0xff;
inline constexpr uint32_t long_names = 0x400; // the only flag of the version word that changes nothing here

enum class PixelType : uint32_t { uint = 0, half = 1, real = 2 };
enum class Compression : uint8_t { none = 0, rle = 1, zips = 2, zip = 3 };

constexpr uint32_t bytes_of(PixelType type) {
  return type == PixelType::half ? 2 : 4;
}
// Scanlines in one chunk.
constexpr uint32_t lines_of(Compression compression) {
  return compression == Compression::zip ? 16 : 1;
}

// Before it is packed, a chunk's bytes at even positions go first, those at odd positions follow, and each
// becomes the difference to the one before. `restore` undoes `prepare`.
std::vector<uint8_t> prepare(std::span<const uint8_t> bytes);
std::vector<uint8_t> restore(std::vector<uint8_t> prepared);

} // namespace dermis::tools::exr_layout
