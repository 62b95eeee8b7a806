#pragma once
// The deflate compression inside OpenEXR chunks.

#include <cstdint>
#include <span>
#include <vector>

namespace dermis::tools {

// Unpacks a zlib stream that must fill `out` exactly; false if it is damaged or has another length.
bool zlib_inflate(std::span<const uint8_t> packed, std::span<uint8_t> out);

// Packs into a zlib stream; empty if memory runs out. At most 2 GiB in.
std::vector<uint8_t> zlib_deflate(std::span<const uint8_t> bytes);

} // namespace dermis::tools
