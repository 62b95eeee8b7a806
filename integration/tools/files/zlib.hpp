#pragma once
// Deflate compression for data inside the viewer's page.

#include <cstdint>
#include <span>
#include <vector>

namespace dermis::tools {

// Packs at most 2 GiB into a zlib stream. Returns an empty vector for larger input or if memory
// runs out.
std::vector<uint8_t> zlib_deflate(std::span<const uint8_t> bytes);

} // namespace dermis::tools
