#include "integration/tools/files/zlib.hpp"

#include "integration/tools/files/stb.hpp"

#include <climits>
#include <cstdlib>

namespace dermis::tools {

namespace {
constexpr int effort = 5; // length of the search for matches; the least that the encoder takes
}

std::vector<uint8_t> zlib_deflate(std::span<const uint8_t> bytes) {
  if (bytes.size() > INT_MAX) return {};
  // The encoder only reads, though its signature does not say so.
  std::vector<uint8_t> copy(bytes.begin(), bytes.end());
  int size = 0;
  unsigned char* packed = stbi_zlib_compress(copy.data(), static_cast<int>(copy.size()), &size, effort);
  std::vector<uint8_t> result(packed, packed ? packed + size : packed);
  std::free(packed);
  return result;
}

} // namespace dermis::tools
