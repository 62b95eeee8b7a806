#pragma once
// Which random graphs a test tries: those from DERMIS_FUZZ_SEED on (0), as many as DERMIS_FUZZ_GRAPHS says.

#include <cstdint>
#include <cstdlib>

namespace dermis::testing {

struct FuzzSeeds {
  uint64_t begin = 0, end = 0; // end: the one behind the last
};

inline FuzzSeeds fuzz_seeds(uint64_t default_graphs) {
  const char* const first = std::getenv("DERMIS_FUZZ_SEED");
  const char* const number = std::getenv("DERMIS_FUZZ_GRAPHS");
  const uint64_t begin = first != nullptr ? std::strtoull(first, nullptr, 10) : 0;
  return {begin, begin + (number != nullptr ? std::strtoull(number, nullptr, 10) : default_graphs)};
}

} // namespace dermis::testing
