#pragma once
// The random graphs that a test tries: DERMIS_FUZZ_GRAPHS graphs from seed DERMIS_FUZZ_SEED
// (default 0).

#include <cstdint>
#include <cstdlib>

namespace dermis::testing {

struct FuzzSeeds {
  uint64_t begin = 0, end = 0; // `end` is one past the last seed.
};

inline FuzzSeeds fuzz_seeds(uint64_t default_graphs) {
  const char* const first = std::getenv("DERMIS_FUZZ_SEED");
  const char* const number = std::getenv("DERMIS_FUZZ_GRAPHS");
  const uint64_t begin = first != nullptr ? std::strtoull(first, nullptr, 10) : 0;
  return {begin, begin + (number != nullptr ? std::strtoull(number, nullptr, 10) : default_graphs)};
}

} // namespace dermis::testing
