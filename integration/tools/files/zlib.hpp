#pragma once
// Deflate compression, for data inside of the viewer's page.

#include <cstdint>
#include <span>
#include <vector>

namespace dermis::tools {

// Packs into a zlib stream; empty if memory runs out. At most 2 GiB in.
std::vector<uint8_t> zlib_deflate(std::span<const uint8_t> bytes);

} // namespace dermis::tools
