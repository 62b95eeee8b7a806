#pragma once
// Caches expensive results in files named by a hash of their inputs.

#include "passes/common/profiles/shape.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace dermis::tools {

// FNV-1a, 64 bits.
struct Hash {
  uint64_t value = 0xcbf29ce484222325u;

  template <class T> void add(std::span<const T> values) {
    const auto* bytes = reinterpret_cast<const unsigned char*>(values.data());
    for (size_t i = 0; i < values.size_bytes(); ++i)
      value = (value ^ bytes[i]) * 0x100000001b3u;
    const uint64_t size = values.size(); // separates adjacent lists
    for (size_t i = 0; i < sizeof size; ++i)
      value = (value ^ ((size >> (8 * i)) & 0xff)) * 0x100000001b3u;
  }
  template <class T> void add(const std::vector<T>& values) { add(std::span<const T>(values)); }
};

// Adds all parameters of the profiles.
void add_shapes(Hash& hash, std::span<const subsurface::ProfileShape> shapes);

// Reads from the folder `cache`; "" disables the cache. Also returns nullopt for an invalid file.
std::optional<std::vector<double>> read_kept(const std::string& cache, const Hash& hash,
                                             size_t count);
// Writes to the cache. Failures are ignored, since they do not affect the measurement.
void keep(const std::string& cache, const Hash& hash, std::span<const double> values);

} // namespace dermis::tools
