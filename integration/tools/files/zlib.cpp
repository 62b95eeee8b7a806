#include "integration/tools/files/zlib.hpp"

#include "integration/tools/files/stb.hpp"

#include <climits>
#include <cstdlib>

namespace dermis::tools {

namespace {
constexpr int effort = 5; // search length for matches; the minimum that stb accepts
}

std::vector<uint8_t> zlib_deflate(std::span<const uint8_t> bytes) {
  if (bytes.size() > INT_MAX) return {};
  // The encoder only reads, but its parameter is not const.
  std::vector<uint8_t> copy(bytes.begin(), bytes.end());
  int size = 0;
  unsigned char* packed =
      stbi_zlib_compress(copy.data(), static_cast<int>(copy.size()), &size, effort);
  std::vector<uint8_t> result(packed, packed ? packed + size : packed);
  std::free(packed);
  return result;
}

} // namespace dermis::tools
